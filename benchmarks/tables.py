"""Make the tables of README and documentation from the stored results, and the picture of speed.

Run: ``python benchmarks/tables.py``
"""

import math
import sys
from collections.abc import Callable, Mapping
from functools import partial

import figures as all_figures
from harness import pages
from harness.figures import Figure, Result, find
from harness.machine import ROOT
from harness.markdown import (
    NOTHING,
    fixed,
    listed,
    measured_on,
    number,
    table,
    value_of,
    with_spread,
)
from recorded import (
    AUTHORS_FIT_MS,
    AUTHORS_SCENES,
    ON_SHELF,
    THESIS_FIT_MS,
    THESIS_INFERENCE_MS,
    OnShelf,
)
from targets import FUSION, OTHERS

Results = Mapping[str, Result]
ANY = "any of them"
NOT_YET = "*Not measured yet.*"
PICTURE = ROOT / "docs" / "pictures" / "speed.svg"

THESIS_SCENES = {
    "walk_J1_C2": "one person",
    "walk_J2_C2": "two people",
    "walk_J3_C2": "three people",
    "walk_J3_occl_C2": "three people, hiding each other",
    "hard_J3_C2": "three people; misses, outliers, false people",
    "cross_lateral_50cm_C2": "two people crossing at 0.5 m",
    "cross_X_occl_C2": "two people crossing, hiding each other",
    "close_entry_J1_C2": "somebody enters 1.5 m from a camera",
    "walk_J3_C4": "three people, four cameras",
}


def accuracy(results: Results, *, short: bool) -> str:
    """Return the table of simulated rooms."""
    result = results["accuracy"]
    head = ["room", "mean joint error [cm]", "with 0.2 s lag [cm]", "joints within 15 cm",
            "identity switches", "missed", "ghosts"]  # fmt: skip
    rows = []
    for room in result.figures:
        at = partial(value_of, result.figures, room, "newest")
        errors = [
            find(result.figures, (room, lag, "mean error")) for lag in ("newest", "lag 0.2 s")
        ]
        rows.append(
            [room, *(_error(error, short=short) for error in errors),
             fixed(at("joints within 15 cm"), 3), fixed(at("switches"), 0),
             f"{fixed(at('missed'), 2)} %", f"{fixed(at('ghosts'), 2)} %"]
        )  # fmt: skip
    return table(head, rows)


def _error(figure: Figure | None, *, short: bool) -> str:
    if short:
        return fixed(figure.value, 1) if figure else NOTHING
    return with_spread(figure)


def thesis(results: Results, *, short: bool) -> str:
    """Return the table of the scenes after the thesis' own."""
    result = results["thesis"]
    head = ["scene, two cameras", "mean joint error [cm]", "with 0.2 s lag [cm]",
            "joints within 15 cm", "author's program (recorded)", "switches"]  # fmt: skip
    rows = []
    for scene, text in THESIS_SCENES.items():
        if scene not in result.figures or (short and scene not in AUTHORS_SCENES):
            continue
        at = partial(value_of, result.figures, scene)
        authors = AUTHORS_SCENES.get(scene)
        rows.append(
            [text, fixed(at("newest", "mean error"), 1), fixed(at("lag 0.2 s", "mean error"), 1),
             fixed(at("newest", "joints within 15 cm"), 3),
             fixed(authors.recall, 2) if authors else NOTHING,
             fixed(at("newest", "switches"), 0)]
        )  # fmt: skip
    return table(head, rows)


def scenes(results: Results) -> str:
    """Return the table of the built-in scenes."""
    made = results["scenes"].figures["scenes"]
    assert isinstance(made, Mapping)
    rows = []
    for scene in made:
        at = partial(value_of, made, scene, "newest")
        rows.append(
            [f"`{scene}`", with_spread(find(made, (scene, "newest", "mean error")), 1),
             fixed(value_of(made, scene, "lag 0.2 s", "mean error"), 1),
             fixed(at("joints within 15 cm"), 3), fixed(at("IDF1"), 1), fixed(at("HOTA"), 1),
             fixed(at("switches"), 0), f"{fixed(at('missed'), 1)} %",
             f"{fixed(at('ghosts'), 1)} %"]
        )  # fmt: skip
    head = ["scene", "mean joint error [cm]", "with 0.2 s lag [cm]", "joints within 15 cm", "IDF1",
            "HOTA", "switches", "missed", "ghosts"]  # fmt: skip
    return table(head, rows)


def postures(results: Results) -> str:
    """Return the errors of people who do not walk relative to those who do."""
    made = results["scenes"].figures["postures"]
    assert isinstance(made, Mapping)
    rows = [
        [posture, with_spread(find(made, (posture, "error / walking"))),
         fixed(value_of(made, posture, "switches"), 0)]
        for posture in made
    ]  # fmt: skip
    return table(["somebody who is", "joint error of that walking", "switches"], rows)


def busy(result: Result) -> str:
    """Return a warning where a machine had too much to do for its times to be quoted."""
    machine = result.about["machine"]
    load = max(machine["load_average"][0], machine["load_average_after"][0])
    if load <= machine["cores"]:
        return ""
    return f"\n\n*The machine was busy (load {load:.1f} on {machine['cores']} cores): too long.*"


def _grid(results: Results) -> tuple[list[int], list[int], Callable[[int, int, str], float]]:
    """Return the numbers of cameras and people that were timed, and how to look a time up."""
    cells = results["speed"].figures["per frame set"]
    assert isinstance(cells, Mapping)
    counts = [tuple(int(word) for word in name.split() if word.isdigit()) for name in cells]

    def at(cameras: int, people: int, name: str) -> float:
        return value_of(cells, f"{cameras} cameras, {people} people", name)

    return sorted({c for c, _ in counts}), sorted({p for _, p in counts}), at


def speed(results: Results) -> str:
    """Return median and 95th percentile over people and cameras [ms]."""
    cameras, people, at = _grid(results)
    rows = [
        [str(p), *(f"{number(at(c, p, 'median'))} / {number(at(c, p, 'p95'))}" for c in cameras)]
        for p in people
    ]
    return table(["people", *(f"{c} cameras" for c in cameras)], rows) + busy(results["speed"])


def speed_short(results: Results) -> str:
    """Return the medians of a few sites [ms]."""
    _, _, at = _grid(results)
    sites = ((2, 3), (4, 4), (4, 10), (12, 10), (12, 50))
    rows = [
        ["fusion per frame set, median [ms]", *(number(at(c, p, "median")) for c, p in sites)],
        ["95th percentile [ms]", *(number(at(c, p, "p95")) for c, p in sites)],
    ]
    made = table(["cameras x people", *(f"{c} x {p}" for c, p in sites)], rows)
    return made + busy(results["speed"])


def thesis_speed(results: Results) -> str:
    """Return the thesis' table 5 [ms] with ours beside it."""
    _, people, at = _grid(results)
    rows = []
    for p in (p for p in people if p <= 10):
        ours = _mean_std(*(at(2, p, name) for name in ("mean", "std", "max", "min")))
        rows.append(
            [
                str(p),
                *ours,
                *_recorded(THESIS_FIT_MS.get(p)),
                number(AUTHORS_FIT_MS.get(p, math.nan)),
            ]
        )
    head = ["people", "mean ± std", "max", "min", "thesis: mean ± std", "max", "min",
            "author's program, recorded on a server like ours"]  # fmt: skip
    return table(head, rows)


def thesis_rate(results: Results) -> str:
    """Return the thesis' table 6, frame sets per second, with ours beside it."""
    _, people, at = _grid(results)
    rows = [
        [str(p), fixed(1e3 / at(2, p, "mean"), 0), fixed(1e3 / at(2, p, "max"), 0),
         fixed(1e3 / THESIS_FIT_MS[p][0], 0) if p in THESIS_FIT_MS else NOTHING,
         fixed(1e3 / THESIS_FIT_MS[p][2], 0) if p in THESIS_FIT_MS else NOTHING]
        for p in people if p <= 10
    ]  # fmt: skip
    head = ["people", "per second", "in the slowest", "thesis: per second", "in the slowest"]
    return table(head, rows)


def growth(results: Results) -> str:
    """Return the exponents of growth."""
    result = results["speed"]
    rows = []
    for fit in ("all", "from 4 people and cameras"):
        at = partial(value_of, result.figures, "growth", fit)
        rows.append([fit, fixed(at("people"), 2), fixed(at("cameras"), 2)])
    rows.append(["author's program (recorded)", "1.75", NOTHING])
    return table(["fitted to", "people to the power of", "cameras to the power of"], rows)


def _mean_std(mean: float, std: float, most: float, least: float) -> list[str]:
    return [f"{number(mean)} ± {number(std)}", number(most), number(least)]


def _recorded(row: tuple[float, float, float, float] | None) -> list[str]:
    return _mean_std(*row) if row else [NOTHING] * 3


def estimator(results: Results) -> str:
    """Return the thesis' tables 7 and 8 with ours beside them."""
    result = results["estimator_speed"]
    rows = []
    for people, name in ((1, "one person"), (2, "two people")):
        at = partial(value_of, result.figures, "per image", name)
        ours = _mean_std(at("mean"), at("std"), at("max"), at("min"))
        rows.append(
            [name, *ours, fixed(1e3 / at("mean"), 0), *_recorded(THESIS_INFERENCE_MS[people])]
        )
    head = ["in the image", "mean ± std [ms]", "max", "min", "images per second",
            "thesis (YOLOv7, GPU): mean ± std [ms]", "max", "min"]  # fmt: skip
    return table(head, rows)


def shelf(results: Results, *, short: bool) -> str:
    """Return ours on Shelf, five cameras, among recorded figures of others."""
    result = results["shelf"]
    rows = []
    for lag, text in (("newest", "trecsim, no lag"), ("lag 0.2 s", "trecsim, 0.2 s lag")):
        at = partial(value_of, result.figures, "5 cameras", lag)
        actors = " / ".join(fixed(at(f"PCP of actor {n}"), 1) for n in (1, 2, 3))
        rows.append(
            [f"**{text}**", actors, fixed(at("average PCP"), 1), fixed(at("PCP of actor 4"), 1),
             f"{fixed(at('switches'), 0)} / {fixed(at('missed person-frames'), 0)}",
             number(at("fusion per frame set"))]
        )  # fmt: skip
    rows += [_other_on_shelf(o) for o in ON_SHELF if not short or o.switches is not None]
    head = ["", "actors 1 / 2 / 3", "average PCP", "actor 4",
            "switches / missed person-frames", "2D to 3D per frame set [ms]"]  # fmt: skip
    return table(head, rows)


def _other_on_shelf(other: OnShelf) -> list[str]:
    told = "published, other detections" if other.published else "recorded"
    return [
        f"{other.name} ({told})",
        " / ".join(fixed(value, 1) for value in other.actors) if other.actors else NOTHING,
        fixed(other.average, 1),
        fixed(other.actor4, 1) if other.actor4 is not None else NOTHING,
        f"{other.switches} / {other.missed}" if other.switches is not None else NOTHING,
        other.ms or NOTHING,
    ]


def everything(results: Results, name: str) -> str:
    """Return all figures of a benchmark."""
    return listed(results[name])


def others(results: Results) -> str:
    """Return what is asked of all but the fusion, and what was reached; without what is missing."""
    some = tuple(t for t in OTHERS if math.isfinite(t.reached(dict(results))))
    return all_figures.table_of(some, dict(results))


def targets(results: Results) -> str:
    """Return what is asked of the fusion, and what was reached."""
    return all_figures.table_of(FUSION, dict(results))


def machine(results: Results) -> str:
    """Return where and when each benchmark ran."""
    return "\n".join(f"- `{name}`: {measured_on(result)}" for name, result in results.items())


NEEDS: dict[str, tuple[str, Callable[[Results], str]]] = {
    "accuracy": ("accuracy", partial(accuracy, short=False)),
    "accuracy-short": ("accuracy", partial(accuracy, short=True)),
    "thesis": ("thesis", partial(thesis, short=False)),
    "thesis-short": ("thesis", partial(thesis, short=True)),
    "scenes": ("scenes", scenes),
    "postures": ("scenes", postures),
    "shelf": ("shelf", partial(shelf, short=False)),
    "shelf-short": ("shelf", partial(shelf, short=True)),
    "speed": ("speed", speed),
    "speed-short": ("speed", speed_short),
    "thesis-speed": ("speed", thesis_speed),
    "thesis-rate": ("speed", thesis_rate),
    "growth": ("speed", growth),
    "estimator": ("estimator_speed", estimator),
    "others": (ANY, others),
    "targets": (ANY, targets),
    "machine": (ANY, machine),
    **{
        name.replace("_", "-") + "-all": (name, partial(everything, name=name))
        for name in ("memory", "simulating", "evaluating", "detector_figures", "real_video",
                     "pipeline_cost", "storing")
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

    cameras, people, at = _grid(results)
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
