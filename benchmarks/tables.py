"""Make the tables of README and documentation from the stored results, and the picture of speed.

Run: ``python benchmarks/tables.py``
"""

import math
import sys
from collections.abc import Callable, Mapping
from functools import partial

import ablation_tables as ablation
import exactness_tables as exact
import figures as all_figures
import forecast_tables as ahead
import movement_tables as moving
import rules_tables as ruling
import settings_table
import speed_tables as fast
import truth
from calibration_targets import CALIBRATION
from harness import pages
from harness.figures import Result, leaves
from harness.machine import ROOT
from harness.markdown import busy, listed, measured_on
from recorded import AUTHORS_FIT_MS
from targets import FUSION, OTHERS
from truth_targets import TRUTH

Results = Mapping[str, Result]
ANY = "any of them"
NOT_YET = "*Not measured yet.*"
PICTURE = ROOT / "docs" / "pictures" / "speed.svg"


def everything(results: Results, name: str) -> str:
    """Return all figures of a benchmark."""
    timed = any(figure.kind == "time" for _, figure in leaves(results[name].figures))
    return listed(results[name]) + (busy(results[name]) if timed else "")


def others(results: Results) -> str:
    """Return what is asked of all but the fusion, and what was reached; without what is missing."""
    some = tuple(t for t in OTHERS if math.isfinite(t.reached(dict(results))))
    return all_figures.table_of(some, dict(results))


def calibration(results: Results) -> str:
    """Return what is asked of calibrations, and what was reached."""
    return all_figures.table_of(CALIBRATION, dict(results))


def targets(results: Results) -> str:
    """Return what is asked of the fusion, and what was reached."""
    return all_figures.table_of(FUSION, dict(results))


def truth_of_claims(results: Results) -> str:
    """Return what is asked of the truth of the claims, what was reached before, and now."""
    return truth.table_of(TRUTH, truth.before(), dict(results))


def settings(_: Results) -> str:
    """Return all settings of the fusion, which nothing has measured."""
    return settings_table.settings()


def machine(results: Results) -> str:
    """Return where and when each benchmark ran."""
    return "\n".join(f"- `{name}`: {measured_on(result)}" for name, result in results.items())


NEEDS: dict[str, tuple[str, Callable[[Results], str]]] = {
    "accuracy": ("accuracy", partial(exact.accuracy, short=False)),
    "accuracy-short": ("accuracy", partial(exact.accuracy, short=True)),
    "thesis": ("thesis", partial(exact.thesis, short=False)),
    "thesis-short": ("thesis", partial(exact.thesis, short=True)),
    "scenes": ("scenes", exact.scenes),
    "postures": ("scenes", exact.postures),
    "movement": ("movement", moving.movement),
    "movement-several": ("movement", moving.several),
    "close-entry": ("close", moving.close_entry),
    "one-camera": ("close", moving.one_camera),
    "one-view": ("one_view", moving.one_view),
    "shelf": ("shelf", partial(exact.shelf, short=False)),
    "shelf-short": ("shelf", partial(exact.shelf, short=True)),
    "shelf-fewer": ("shelf", exact.shelf_fewer),
    "detector-figures": ("detector_figures", exact.detector),
    "shared-errors": ("shared_errors", exact.shared),
    "noise": ("noise", exact.noise),
    "speed": ("speed", fast.speed),
    "speed-short": ("speed", fast.speed_short),
    "pipeline-short": ("estimator_speed", fast.pipeline_short),
    "live-short": ("live", fast.live_short),
    "thesis-speed": ("speed", fast.thesis_speed),
    "thesis-rate": ("speed", fast.thesis_rate),
    "growth": ("speed", fast.growth),
    "beside-author": (ANY, fast.beside_author),
    "beside-pose2sim": ("beside_pose2sim", fast.beside_pose2sim),
    "estimator": ("estimator_speed", fast.estimator),
    "ablation": ("ablation", ablation.ablation),
    "ablation-instead": ("ablation", ablation.instead),
    "ablation-idle": ("ablation", ablation.idle),
    "fusion-settings": (ANY, settings),
    "others": (ANY, others),
    "targets": (ANY, targets),
    "calibration": (ANY, calibration),
    "truth": (ANY, truth_of_claims),
    "forecast": ("forecast", partial(ahead.forecast, short=False)),
    "forecast-poses": ("forecast", ahead.poses),
    "forecast-short": ("forecast", partial(ahead.forecast, short=True)),
    "rules": ("rules", ruling.rules),
    "rules-falls": ("rules", ruling.falls),
    "rules-traffic": ("rules", ruling.traffic),
    "rules-days": ("normal_days", ruling.days),
    "machine": (ANY, machine),
    **{
        name.replace("_", "-") + "-all": (name, partial(everything, name=name))
        for name in ("memory", "arrival", "soak", "simulating", "evaluating", "real_video",
                     "pipeline_cost", "reading", "storing", "live", "soak_live", "page",
                     "page_start", "streams", "forecast")
    },
}  # fmt: skip
"""Every table: the benchmark it needs, and what makes it."""


def tables(results: Results) -> dict[str, Callable[[], str]]:
    """Return what makes each table, by name."""

    def made(name: str) -> str:
        needs, make = NEEDS[name]
        return make(results) if needs in results or (needs == ANY and results) else NOT_YET

    return {name: partial(made, name) for name in NEEDS}


def draw(results: Results) -> None:
    """Draw time per frame set over people, a line for each number of cameras."""
    from harness.pictures import log_log

    cameras, people, at = fast.grid(results)
    lines = {
        f"{c} cameras": [
            (p, at(c, p, "median")) for p in people if math.isfinite(at(c, p, "median"))
        ]
        for c in cameras
    }
    recorded = {"author's program, 2 cameras (recorded)": sorted(AUTHORS_FIT_MS.items())}
    log_log(PICTURE, lines, recorded)


def main() -> int:
    """Fill the pages; return the exit status."""
    results = all_figures.results()
    for page in pages.PAGES:
        changed = pages.fill(page, tables(results))
        print(f"{page.relative_to(ROOT)}: {'changed' if changed else 'as it was'}")
    if "speed" in results:
        draw(results)
        print(PICTURE.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())
