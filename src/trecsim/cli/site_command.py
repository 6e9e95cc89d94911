"""The commands `trecsim site new`, `trecsim site check` and `trecsim site schema`."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.terminal import counted, finish, note
from trecsim.errors import InputError
from trecsim.redaction import redacted

if TYPE_CHECKING:
    from trecsim.sites.site_file import Site, SourceTable
    from trecsim.sources import VideoInfo

_NAMED = re.compile(r"[^=/:]+=(\w+://|/dev/)")  # NAME=ADDRESS


def new(
    *inputs: str,
    rig: Path,
    out: Path = Path("site.toml"),
    name: str | None = None,
    fps: float | None = None,
    json: bool = False,
) -> None:
    """Write a site file for live cameras, for videos, or for 2D poses.

    The file is checked afterwards; what is wrong is said, and the file kept.

    Parameters
    ----------
    inputs
        Live cameras as NAME=rtsp://ADDRESS or NAME=/dev/videoN, NAME as in the rig. Or videos, one
        per camera, or directories of videos: a video belongs to the camera of the rig whose name is
        in its file name, or to NAME in NAME=VIDEO. Or one file or directory of 2D poses.
    rig
        The calibration of the cameras, in any format that is read.
    out
        The site file to write; it is never overwritten.
    name
        Name of the site (default: that of the folder).
    fps
        Frames per second of 2D poses that number their frames.
    json
        Print the summary as one JSON object.
    """
    from trecsim.cli.estimate_command import cameras_of
    from trecsim.sites.check import check_site
    from trecsim.sites.new_site import write_site

    if not inputs:
        raise InputError(
            "no camera is given; expected: trecsim site new NAME=rtsp://ADDRESS... --rig RIG, or "
            "VIDEO... --rig RIG"
        )
    streams = _streams(inputs)
    poses = Path(inputs[0]).expanduser() if len(inputs) == 1 and _is_poses(inputs[0]) else None
    videos = None if poses or streams else cameras_of(inputs)
    matched = write_site(
        out, rig, videos=videos, streams=streams, poses=poses, fps=fps, name=name, remark=note
    )
    faults = None
    try:
        for remark in check_site(out).remarks:
            note(remark)
    except InputError as error:
        faults = str(error)
        note(f"the file is written, but: {faults}")
    sources = streams or matched
    summary = {"out": out, "sources": sources, "poses": poses, "faults": faults}
    finish(summary, json, f"{out}: {', '.join(sources) or poses}")


def _streams(inputs: Sequence[str]) -> dict[str, str]:
    """Return the addresses of live cameras by the name of the camera; empty for recordings."""
    live = [given for given in inputs if "://" in given or "/dev/video" in given]
    if not live:
        return {}
    named = dict(given.split("=", 1) for given in live if _NAMED.match(given))
    if len(named) < len(inputs):
        raise InputError(
            "expected each camera of a live site once, as NAME=rtsp://ADDRESS or NAME=/dev/videoN"
        )
    return named


def _is_poses(given: str) -> bool:
    """Tell whether an input is 2D poses rather than a video or a directory of videos."""
    from trecsim.cli.estimate_command import _VIDEOS

    path = Path(given).expanduser()
    if path.is_dir():
        return not any(file.suffix.lower() in _VIDEOS for file in path.iterdir())
    return path.suffix.lower() in (".jsonl", ".json", ".partial")


def check(site: Path, /, *, json: bool = False) -> None:
    """Check a site file and everything it names.

    Checks the keys, that the rig can be read, that each video opens and belongs to a camera of the
    rig, and the settings of estimator and fusion. All faults are listed at once, by line. Live
    cameras are not connected: `trecsim doctor SITE` does that.

    Parameters
    ----------
    site
        The site file.
    json
        Print the summary as one JSON object.
    """
    from trecsim.sites.check import check_site

    checked = check_site(site)
    for remark in checked.remarks:
        note(remark)
    settings = checked.file.site
    summary = {
        "site": settings.name,
        "cameras": list(checked.rig.names),
        "sources": {
            camera: _source_facts(source, checked.videos.get(camera))
            for camera, source in settings.sources.items()
        },
        "poses": settings.poses.file if settings.poses else None,
        "estimator": settings.estimator.name if settings.sources else None,
        "remarks": checked.remarks,
    }
    inputs = _counted(settings) if settings.sources else f"{summary['poses']}"
    finish(summary, json, f"{site}: good ({len(checked.rig)} cameras, {inputs})")


def _source_facts(source: "SourceTable", video: "VideoInfo | None") -> dict[str, object]:
    if source.video is not None:
        return {"video": source.video, "seconds": video.duration_s if video else None}
    return {"url": redacted(source.url)} if source.url else {"device": source.device}


def _counted(site: "Site") -> str:
    live = sum(source.is_live for source in site.sources.values())
    videos = len(site.sources) - live
    told = [(live, "live stream"), (videos, "video")]
    return ", ".join(counted(count, what) for count, what in told if count)


def schema(*, json: bool = False) -> None:
    """Print the JSON schema of site files.

    Editors that know TOML (Even Better TOML, taplo) complete and check a site file that begins
    with `#:schema trecsim-site.schema.json`, when that file lies beside it:
    `trecsim site schema > trecsim-site.schema.json`.

    Parameters
    ----------
    json
        Print it on one line.
    """
    from json import dumps

    from trecsim.sites import site_schema

    found = site_schema()
    finish(found, json, dumps(found, indent=2))
