"""PCP3D on the Shelf recording, after the protocol in ``docs/reference/pcp.md``.

Real detections of five cameras (OpenPose) in the 301 frames of the literature, 300 to 600. With a
lag the last frames, which lagged tracks cannot reach before the recording ends, are not scored. The
recording is data beside the repository; what other programs reached on the same detections and
frames stands in ``recorded.py``.

Run: ``python benchmarks/shelf.py``; ``python benchmarks/shelf.py --convert FOLDER OUT`` writes the
recording as ``rig.toml``, ``poses.jsonl`` and ``truth.npz`` instead, for ``trecsim track``.
"""

import statistics
import sys
from collections.abc import Mapping
from itertools import combinations
from pathlib import Path
from typing import Any

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figure, Figures, once, timed
from harness.options import Options, settings_from, shared_data
from harness.scoring import LAGS_S

ROUNDS = 3
FEWER = (4, 3, 2)
ACTORS = (1, 2, 3, 4)
PCP_MATTERS = 0.2  # points: two parts of actor 2, who is annotated in 37 frames

Task = tuple[Path, tuple[str, ...] | None, float, Mapping[str, Any]]


def scores(task: Task) -> dict[str, float]:
    """Track with some of the cameras, score, and return the figures by name."""
    from harness.shelf_recording import read_shelf
    from trecsim.lab.evaluation.shelf import score_shelf
    from trecsim.tracking import Tally, follow

    folder, cameras, lag_s, overrides = task
    shelf, tally = read_shelf(folder, cameras), Tally()
    snapshots = follow(shelf.poses, shelf.rig, settings_from(overrides), lag_s=lag_s, tally=tally)
    score = score_shelf(snapshots, shelf.annotation, lag_s=lag_s)
    return {
        "average PCP": score.average,
        **{f"PCP of actor {actor.actor}": actor.pcp for actor in score.actors},
        **{f"PCP of the {group}": share for group, share in score.groups.items()},
        "limb-joint error": 1e3 * score.mpjpe_m,
        "people found within 0.5 m": 100 * score.recall,
        "switches": score.switches,
        "missed person-frames": score.missed,
        "identities": tally.people,
        "fusion per frame set": tally.fusion_ms()["median"],
    }


def all_cameras(folder: Path, options: Options, lag_s: float) -> Figures:
    """Return the figures with all five cameras; the time is the median of some rounds."""
    rounds, calibration = [], []
    found: dict[str, float] = {}
    for _ in range(1 if options.quick else ROUNDS):
        before_ms = calibration_ms()
        found = scores((folder, None, lag_s, options.overrides))
        rounds.append(found["fusion per frame set"])
        calibration.append((before_ms + calibration_ms()) / 2)
    figures: dict[str, Figure] = {name: _once(name, value) for name, value in found.items()}
    figures["fusion per frame set"] = timed(rounds, calibration, watched=False)
    return figures


def _once(name: str, value: float) -> Figure:
    if "PCP" in name:
        return once(value, "%", "higher", PCP_MATTERS, watched="of the" not in name)
    if name == "people found within 0.5 m":
        return once(value, "%", "higher", 0.3)
    if name == "limb-joint error":
        return once(value, "mm")
    return once(value, "", matters=0.0, watched=name != "identities")


def subsets(found: Mapping[str, Mapping[str, float]]) -> Figures:
    """Return figures over all choices of so many cameras."""

    def over(name: str) -> dict[str, float]:
        return {cameras: values[name] for cameras, values in found.items()}

    pcp, switches, missed = (
        over(name) for name in ("average PCP", "switches", "missed person-frames")
    )
    mean = statistics.fmean(pcp.values())
    ms = statistics.median(over("fusion per frame set").values())
    return {
        "average PCP": Figure(mean, "%", "higher", "mean", pcp, matters=PCP_MATTERS),
        "worst average PCP": once(min(pcp.values()), "%", "higher", PCP_MATTERS),
        "switches": Figure(sum(switches.values()), "", "lower", "sum", switches),
        "missed person-frames": Figure(sum(missed.values()), "", "lower", "sum", missed),
        # Measured in several processes at a time: to be read, not compared.
        "fusion per frame set": once(ms, "ms", watched=False),
    }


def measure(options: Options) -> Figures:
    """Measure PCP3D and identities on the Shelf recording, with five cameras and with fewer."""
    from harness.shelf_recording import read_cameras

    folder = options.folder or shared_data("shelf")
    options.input.update(data="shelf beside the repository")
    names = read_cameras(folder).names
    figures: dict[str, Figures] = {
        f"{len(names)} cameras": {
            lag: all_cameras(folder, options, lag_s) for lag, lag_s in LAGS_S.items()
        }
    }
    for count in () if options.quick else FEWER:
        chosen = list(combinations(names, count))
        tasks = [(folder, cameras, 0.0, options.overrides) for cameras in chosen]
        found = options.over(scores, tasks, f"{count} cameras")
        by_name = {" ".join(cameras): one for cameras, one in zip(chosen, found, strict=True)}
        figures[f"{count} cameras"] = {"newest": subsets(by_name)}
    return figures


def convert(arguments: list[str]) -> int:
    """Write the recording in the formats that ``trecsim track`` takes."""
    from harness.shelf_recording import convert_shelf
    from trecsim.errors import Error

    if len(arguments) != 2:
        print("usage: python benchmarks/shelf.py --convert FOLDER OUT", file=sys.stderr)
        return 2
    try:
        convert_shelf(*arguments)
    except Error as error:
        print(error, file=sys.stderr)
        return error.exit_code
    return 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--convert"]:
        raise SystemExit(convert(sys.argv[2:]))
    raise SystemExit(alone(__file__, measure))
