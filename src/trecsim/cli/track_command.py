"""The command `trecsim track`."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from trecsim.cli.first_run import compile_first
from trecsim.cli.rig_options import RigOptions
from trecsim.cli.terminal import counted_people, finish, fusion_time, progress_bar
from trecsim.errors import InputError

_OF_RIGS = (".toml", ".yml", ".yaml", ".xml", ".txt")  # and of no 2D poses
Reading = Annotated[RigOptions, Parameter(name="*")]
Names = Annotated[tuple[str, ...], Parameter(show_default=False)]


def track(
    rig: Path,
    poses: Path,
    /,
    *,
    out: Path = Path("tracks.csv"),
    lag_s: float = 0.0,
    fps: float | None = None,
    names: Names = (),
    timing: Path | None = None,
    provisional: bool = False,
    reading: Reading = RigOptions(),  # noqa: B008
    json: bool = False,
) -> None:
    """Track people in 3D from 2D poses.

    Writes one state per person and frame set, at the newest time of the set minus the lag.

    Parameters
    ----------
    rig
        Calibration: a file or directory in any format that `trecsim rig show` reads.
    poses
        2D poses: a `*.poses.jsonl` file, a directory of OpenPose results or a Pose2Sim project, or
        results of MMPose or COCO tools.
    out
        The file to write: `*.csv` or `*.parquet`.
    lag_s
        Report each state this long after the newest image [s]. Later images make it smoother.
    fps
        Frames per second, for poses without time stamps.
    names
        NAME=CAMERA: the camera of the rig for a name in the poses; once for each such camera.
    timing
        Also write the time of each frame set to this CSV file: `t_s,images,people,fusion_ms`.
    provisional
        Also write people whose track is not confirmed yet. In Parquet their `state` is
        `provisional`; CSV has no column for it.
    json
        Print the summary as one JSON object.
    """
    from trecsim.pipeline import track as run

    _check_order(rig, poses)
    cameras = reading.read(rig)
    compile_first(quiet=json)
    with progress_bar("frame sets", quiet=json) as bar:
        summary = run(
            cameras,
            poses,
            out,
            lag_s=lag_s,
            fps=fps,
            names=_names(names),
            timing=timing,
            provisional=provisional,
            progress=bar,
        )
    people, sets = counted_people(summary["people"]), summary["frame_sets"]
    text = f"{out}: {people} in {sets} frame sets{fusion_time(summary['fusion_ms'])}"
    finish(summary, json, text)


def _names(given: tuple[str, ...]) -> dict[str, str]:
    """Return the camera of the rig by the name in the poses."""
    pairs = [pair.partition("=") for pair in given]
    if any(not (name and camera) for name, _, camera in pairs):
        raise InputError(f"--names: expected NAME=CAMERA, found {' '.join(given)}")
    return {name: camera for name, _, camera in pairs}


def _check_order(rig: Path, poses: Path) -> None:
    """Reject two files in the wrong order, or one of them given twice."""
    if _is_poses(rig):
        right = "RIG" if _is_poses(poses) else poses
        raise InputError(
            f"{rig} is a file of 2D poses; give the rig first: trecsim track {right} {rig}"
        )
    if poses.is_file() and poses.suffix.lower() in _OF_RIGS and not _is_poses(poses):
        right = "POSES" if rig.suffix.lower() in _OF_RIGS or not rig.exists() else rig
        raise InputError(
            f"{poses} is a calibration by its name, not a file of 2D poses; give the rig first, "
            f"then the poses: trecsim track {poses} {right}"
        )


def _is_poses(path: Path) -> bool:
    if not path.is_file():
        return False
    from trecsim.store.atomic import opened_for_reading

    with opened_for_reading(path) as file:
        return path.suffix.lower() == ".jsonl" or b'"trecsim.poses2d/' in file.read(200)
