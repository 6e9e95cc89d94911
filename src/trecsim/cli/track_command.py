"""The command `trecsim track`."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from trecsim.cli.rig_options import RigOptions
from trecsim.cli.terminal import counted_people, finish, progress_bar
from trecsim.errors import InputError

_OF_RIGS = (".toml", ".yml", ".yaml", ".xml", ".txt")  # and of no 2D poses
Reading = Annotated[RigOptions, Parameter(name="*")]


def track(
    rig: Path,
    poses: Path,
    /,
    *,
    out: Path = Path("tracks.csv"),
    lag_s: float = 0.0,
    fps: float | None = None,
    timing: Path | None = None,
    reading: Reading = RigOptions(),  # noqa: B008
    json: bool = False,
) -> None:
    """Reconstruct everybody's 3D trajectory from 2D poses.

    One state per person and frame set, at the newest time of the set minus the lag.

    Parameters
    ----------
    rig
        Calibration: a file or directory in any format that `trecsim rig show` reads.
    poses
        2D poses: a `*.poses.jsonl` file, a directory of OpenPose results, or COCO results.
    out
        Where the tracks go: `*.csv` or `*.parquet`.
    lag_s
        Report this much later than the newest image, and smoother [s].
    fps
        Frames per second, for poses that number their frames and tell no time.
    timing
        Also write what each frame set cost: `t_s,images,people,fusion_ms` (CSV).
    json
        Print the summary as one JSON object.
    """
    from trecsim.pipeline import track as run

    _check_order(rig, poses)
    cameras = reading.read(rig)
    with progress_bar("frame sets", quiet=json) as bar:
        summary = run(cameras, poses, out, lag_s=lag_s, fps=fps, timing=timing, progress=bar)
    ms = summary["fusion_ms"]
    text = (
        f"{out}: {counted_people(summary['people'])} in {summary['frame_sets']} frame sets; "
        f"fusion {ms['median']:.2f} ms per set (p95 {ms['p95']:.2f})"
    )
    finish(summary, json, text)


def _check_order(rig: Path, poses: Path) -> None:
    """Tell who gave the two files the other way round, or one of them twice."""
    if _is_poses(rig):
        right = "RIG" if _is_poses(poses) else poses
        raise InputError(
            f"{rig} is a file of 2D poses; the rig comes first: trecsim track {right} {rig}"
        )
    if poses.is_file() and poses.suffix.lower() in _OF_RIGS and not _is_poses(poses):
        right = "POSES" if rig.suffix.lower() in _OF_RIGS or not rig.exists() else rig
        raise InputError(
            f"{poses} is no file of 2D poses but a calibration, by its name; the rig comes first, "
            f"then the poses: trecsim track {poses} {right}"
        )


def _is_poses(path: Path) -> bool:
    if not path.is_file():
        return False
    from trecsim.store.atomic import opened_for_reading

    with opened_for_reading(path) as file:
        return path.suffix.lower() == ".jsonl" or b'"trecsim.poses2d/' in file.read(200)
