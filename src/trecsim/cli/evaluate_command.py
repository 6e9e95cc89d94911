"""The command `trecsim evaluate`."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trecsim.cli.terminal import finish, note, progress_bar

if TYPE_CHECKING:
    from trecsim.lab.evaluation.evaluating import Evaluation


def evaluate(
    tracks: list[Path],
    /,
    *,
    truth: Path | None = None,
    shelf: Path | None = None,
    lag_s: float = 0.0,
    rig: Path | None = None,
    poses: Path | None = None,
    lengths: Path | None = None,
    left_out: bool | None = None,
    from_s: float | None = None,
    to_s: float | None = None,
    details: bool = False,
    json: bool = False,
) -> None:
    """Evaluate tracks with or without ground truth.

    Several tracks are shown side by side, for example without and with a lag. Frames without
    people count, too: their times are read from a `timing.csv` beside the tracks; without one they
    are assumed at the median interval.

    Parameters
    ----------
    tracks
        Files `*.csv` or `*.parquet`, or directories of recordings.
    truth
        Ground truth: `truth.npz`, or the directory of a simulated scene.
    shelf
        Directory of the Shelf recording, to compute PCP3D over all its frames.
    lag_s
        Smoothing lag of the tracks [s]; goes with `--shelf`, whose last frames of that length are
        not scored, since the recording ends before lagged tracks reach them, and with `--left-out`.
    rig
        Calibration, for reprojection errors; needs `--poses`.
    poses
        The 2D poses the tracks were computed from; needs `--rig`.
    lengths
        Limb lengths measured with a tape (TOML), to compare with.
    left_out
        Track once more without each camera, and check whether its key points are where the others
        say, as surely as they say; needs `--rig` and `--poses` of three cameras or more. Done by
        itself up to 12,000 images.
    from_s
        Evaluate from this time on [s].
    to_s
        Evaluate until this time [s].
    details
        Show every joint, and every limb of every person.
    json
        Print all scores as one JSON object.
    """
    from trecsim.cli.score_table import details_table, score_table
    from trecsim.lab.evaluation.evaluating import evaluate as run

    with progress_bar("evaluation", quiet=json) as bar:
        results = [
            run(
                path,
                truth,
                shelf=shelf,
                lag_s=lag_s,
                rig=rig,
                poses=poses,
                lengths=lengths,
                left_out=left_out,
                from_s=-float("inf") if from_s is None else from_s,
                until_s=float("inf") if to_s is None else to_s,
                remark=note,
                progress=bar,
            )
            for path in tracks
        ]
    text = "\n\n".join([score_table(results), *(map(details_table, results) if details else ())])
    summary = {"truth": truth, "shelf": shelf, "tracks": [_facts(result) for result in results]}
    finish(summary, json, text)


def _facts(result: "Evaluation") -> dict[str, Any]:
    shelf, seen = result.shelf, result.reprojection
    fragmentations = [asdict(one) for one in result.fragmentations]
    return {
        "tracks": result.tracks,
        "moments": result.moments,
        "people": result.people,
        "first_s": result.first_s,
        "last_s": result.last_s,
        "scores": result.scores and result.scores.row(),
        "shelf": shelf and {**shelf.summary(), "actors": [actor.row() for actor in shelf.actors]},
        "limbs": {
            **result.limb_summary.row(),
            "rows": [row.row() for row in result.limbs],
        },
        "jitter": [row.row() for row in result.jitter],
        "support": [row.row() for row in result.support],
        "lifetimes": [life.row() for life in result.lifetimes],
        "breaks": fragmentations,  # former name
        "fragmentations": fragmentations,
        "reprojection": seen
        and {
            "joints": [asdict(row) for row in seen.rows],
            "cameras": [row.row() for row in seen.cameras],
        },
        "left_out": result.left_out and result.left_out.row(),
    }
