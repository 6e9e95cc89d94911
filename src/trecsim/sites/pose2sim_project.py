"""A project of Pose2Sim as a site: its calibration, and its 2D poses or videos."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from trecsim.errors import ConfigError
from trecsim.sites.new_site import write_site
from trecsim.toml_models import parsed, read_text

SITE = "site.toml"
_KIND = "project of Pose2Sim"
_TABLES = {"project", "pose", "calibration", "triangulation", "synchronization"}
_LEVELS = 3  # a trial lies in a participant, which lies in a session: any of them calibrates
_VIDEO_ENDINGS = ("mp4", "avi", "mov", "mkv", "mpg")


def is_project(path: Path) -> bool:
    """Return whether a path is the `Config.toml` of a project of Pose2Sim.

    Raises
    ------
    ConfigError
        When it is a file of that name that is no TOML.
    """
    if path.name != "Config.toml" or not path.is_file():
        return False
    said = parsed(path, read_text(path, _KIND), _KIND)
    return "format" not in said and bool(_TABLES & said.keys())


def site_of_project(config: Path, remark: Callable[[str], None]) -> Path:
    """Return the site file beside the `Config.toml` of a project; write it where there is none.

    2D poses are taken as Pose2Sim takes them: those that it has synchronised, else those of the
    estimator; without poses the videos are taken.

    Parameters
    ----------
    config
        The project's `Config.toml`.
    remark
        Is told what was found, and what of the project is not used.

    Raises
    ------
    ConfigError
        When calibration, or poses and videos, are missing.
    InputError
        When they do not belong together.
    """
    out = config.parent / SITE
    if out.exists():
        remark(f"{out} is used; delete it to have it written again from {config.name}")
        return out
    said = parsed(config, read_text(config, _KIND), _KIND)
    project = _table(said, "project")
    rig = _calibration(config)
    poses = _poses(config.parent)
    fps = _rate(project)
    videos = {} if poses else _videos(config.parent, _table(said, "pose"))
    if not poses and not videos:
        raise ConfigError(
            f"{config}: expected 2D poses in {config.parent / 'pose'} or videos in "
            f"{config.parent / 'videos'}; found neither"
        )
    for name in _not_used(project, bool(poses)):
        remark(f"{config.name}: {name}")
    write_site(out, rig, videos=videos, poses=poses, fps=fps, remark=remark)
    source = poses.name if poses else f"{len(videos)} videos"
    remark(f"{out} is written: rig from {rig.name}, {source}; edit it to change settings")
    return out


def _calibration(config: Path) -> Path:
    """Return the calibration of the project, or of what it is a part of."""
    folder = config.absolute().parent
    for level in [folder, *folder.parents][:_LEVELS]:
        for place in sorted(level.glob("[Cc]alib*")):
            files = [place] if place.is_file() else sorted(place.glob("[Cc]alib*.toml"))
            if place.is_dir() and not files:
                files = [place]
            if files and (files[0].is_dir() or files[0].suffix in (".toml", ".txt")):
                return files[0]
    raise ConfigError(
        f"{config}: expected a calibration, such as {folder / 'calibration' / 'Calib_scene.toml'}, "
        "here or up to two folders above; found none"
    )


def _poses(folder: Path) -> Path | None:
    for name in ("pose-associated", "pose-sync", "pose"):
        if any((folder / name).glob("*_json/*.json")):
            return folder / name
    return None


def _videos(folder: Path, pose: Mapping[str, Any]) -> dict[str, Path]:
    given = pose.get("vid_img_extension")
    endings = (str(given).lstrip("."), *_VIDEO_ENDINGS) if given else _VIDEO_ENDINGS
    for ending in endings:
        found = sorted((folder / "videos").glob(f"*.{ending}"))
        if found:
            return {path.stem: path for path in found}
    return {}


def _rate(project: Mapping[str, Any]) -> float | None:
    """Return the frame rate; None for `auto`, which is left to the videos or to a remark."""
    rate = project.get("frame_rate")
    return float(rate) if isinstance(rate, int | float) and rate > 0 else None


def _not_used(project: Mapping[str, Any], has_poses: bool) -> list[str]:
    told = []
    if project.get("frame_range") not in (None, [], "all", "auto"):
        told.append("frame_range is not used: all frames are tracked")
    if has_poses and project.get("frame_rate") in (None, "auto"):
        told.append(
            "frame_rate is automatic: set fps under [poses] in the site file if it is not 30"
        )
    if not has_poses:
        told.append(
            "the videos are taken as synchronous; set time_offset_s in the rig if they are not"
        )
    return told


def _table(said: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found = said.get(name)
    return found if isinstance(found, dict) else {}
