"""Write a site file for live cameras, videos or 2D poses and the rig that they belong to."""

import os
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from json import dumps
from pathlib import Path

from trecsim.calibration import read_rig
from trecsim.errors import InputError
from trecsim.redaction import redacted
from trecsim.sources import read_poses
from trecsim.sources.camera_names import candidates
from trecsim.sources.streams.camera_login import variable
from trecsim.store.atomic import atomic_write

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def write_site(
    out: Path,
    rig: Path,
    *,
    videos: Mapping[str, Path] | None = None,
    streams: Mapping[str, str] | None = None,
    poses: Path | None = None,
    fps: float | None = None,
    name: str | None = None,
    remark: Callable[[str], None],
) -> dict[str, Path]:
    """Write a site file with comments on what can be set.

    Parameters
    ----------
    out
        The file; its folder must be there, and it must not.
    rig
        The calibration, in any format that is read.
    videos
        The videos by the name of their camera; a name that the rig lacks is matched to the only
        camera whose name is a word of it.
    streams
        Live cameras in place of videos: an address or a device for each camera of the rig.
    poses
        2D poses, in place of videos.
    fps
        Frames per second of poses that number their frames.
    name
        Of the site; by default that of its folder.
    remark
        Is called with what was matched, and what is doubtful about the rig.

    Returns
    -------
    The videos by the camera of the rig.

    Raises
    ------
    InputError
        When something is not there, a video or stream belongs to no camera of the rig, or an
        address holds a password; all in one message.
    """
    if out.exists():
        raise InputError(f"{out} is there already and is not overwritten; give another --out")
    cameras = read_rig(rig, remark=remark).names
    check_streams(streams or {}, cameras)
    matched = matched_cameras(videos or {}, cameras, remark)
    if poses is not None:
        next(read_poses(poses, rig_cameras=cameras, fps=fps, remark=lambda text: None), None)
    folder = out.absolute().parent
    lines = _head(name or folder.name, _seen_from(folder, rig))
    if poses is not None:
        lines += _poses(_seen_from(folder, poses), fps)
    elif streams:
        lines += _sources({camera: _live(camera, given) for camera, given in streams.items()})
        lines += _PAGE
    else:
        paths = {camera: _seen_from(folder, path) for camera, path in matched.items()}
        lines += _sources({camera: [f"video = {_text(path)}"] for camera, path in paths.items()})
    with atomic_write(out) as file:
        file.write("\n".join([*lines, *_OUTPUT]) + "\n")
    return matched


def matched_cameras(
    videos: Mapping[str, Path], cameras: Collection[str], remark: Callable[[str], None]
) -> dict[str, Path]:
    """Return the videos by the camera of the rig, in the order of the rig.

    Raises
    ------
    InputError
        When a video belongs to no camera, or two to one.
    """
    faults: list[str] = []
    found: dict[str, str] = {}
    for name, path in videos.items():
        near = candidates(name, cameras)
        if len(near) != 1:
            which = (
                f"could be of {' or '.join(near)}" if near else "belongs to no camera of the rig"
            )
            faults.append(f"{path} {which} (it has {', '.join(cameras)}); say which: NAME={path}")
        elif near[0] in found:
            other = videos[found[near[0]]]
            faults.append(
                f"{other} and {path} are both of the camera {near[0]!r}; give one of them"
            )
        else:
            found[near[0]] = name
            if near[0] != name:
                remark(f"{path} is taken for the camera {near[0]!r}; if that is wrong: NAME={path}")
    if faults:
        raise InputError("\n".join(faults))
    return {camera: videos[found[camera]] for camera in cameras if camera in found}


def check_streams(streams: Mapping[str, str], cameras: Collection[str]) -> None:
    """Check the addresses of live cameras.

    Raises
    ------
    InputError
        When one belongs to no camera of the rig, or holds a user or password.
    """
    faults = [
        f"there is no camera {name!r} in the rig (it has {', '.join(cameras)})"
        for name in streams
        if name not in cameras
    ]
    faults += [
        f"{name}: leave user and password out of {redacted(given)}; the site file that is "
        "written then says where they go (credentials)"
        for name, given in streams.items()
        if redacted(given) != given
    ]
    if faults:
        raise InputError("\n".join(faults))


def _seen_from(folder: Path, path: Path) -> str:
    """Return a path as seen from a folder if it is inside, else the absolute path."""
    absolute = path.expanduser().absolute()
    inside = absolute.is_relative_to(folder)
    return Path(os.path.relpath(absolute, folder) if inside else absolute).as_posix()


def _head(name: str, rig: str) -> list[str]:
    plain = re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")[:64] or "site"
    return [
        "# What is installed where, and how it runs. Paths are relative to this file.",
        "# Check it with: trecsim site check FILE; run it with: trecsim run FILE",
        'format = "trecsim.site/1"',
        f"name = {_text(plain)}  # letters, digits, - and _",
        f"rig = {_text(rig)}  # the calibration of the cameras",
    ]


def _sources(tables: Mapping[str, Sequence[str]]) -> list[str]:
    lines = ["", "# One table per camera, by its name in the rig."]
    for camera, inside in tables.items():
        key = camera if _BARE.fullmatch(camera) else _text(camera)
        lines += [f"[sources.{key}]", *inside]
    return [*lines, "", "[estimator]", 'name = "movenet"  # or "onnx:FILE", "rtmlib:rtmo-m"']


def _live(camera: str, given: str) -> list[str]:
    if "://" not in given:
        return [f"device = {_text(given)}"]
    login = re.sub(r"[^A-Za-z0-9_-]+", "-", camera)
    return [
        f"url = {_text(given)}",
        f'# credentials = "{login}"  # if it wants them: {variable(login)} holds user:password',
    ]


def _poses(poses: str, fps: float | None) -> list[str]:
    if fps is None:
        return [f"poses = {_text(poses)}  # 2D poses, so no video is read"]
    return [f"poses = {{ file = {_text(poses)}, fps = {fps!r} }}  # 2D poses, so no video is read"]


_PAGE = (
    "",
    "[page]  # the live page, for this machine alone; for others: users or token_env",
    "port = 8765",
)
_OUTPUT = (
    "",
    "[output]",
    '# directory = "recordings"  # gets one folder per run',
    "lag_s = 0.0  # wait for later images [s]: smoother tracks",
    "poses = false  # keep the 2D poses too",
)


def _text(value: str) -> str:
    return dumps(value, ensure_ascii=False)
