"""The command `trecsim track`."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from trecsim.cli.rig_options import RigOptions
from trecsim.cli.terminal import counted_people, finish, progress_bar

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

    cameras = reading.read(rig)
    with progress_bar("frame sets", quiet=json) as bar:
        summary = run(cameras, poses, out, lag_s=lag_s, fps=fps, timing=timing, progress=bar)
    ms = summary["fusion_ms"]
    text = (
        f"{out}: {counted_people(summary['people'])} in {summary['frame_sets']} frame sets; "
        f"fusion {ms['median']:.2f} ms per set (p95 {ms['p95']:.2f})"
    )
    finish(summary, json, text)
