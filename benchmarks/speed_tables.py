"""Tables of how long things take."""

import math
from collections.abc import Callable, Mapping
from functools import partial

from harness.figures import Result
from harness.markdown import NOTHING, busy, fixed, machine_of, number, table, value_of
from recorded import (
    AUTHORS_FIT_MS,
    BESIDE_AUTHOR,
    ESTIMATOR_AVX2_MS,
    THESIS_FIT_MS,
    THESIS_INFERENCE_MS,
)
from speed import LENSED, cell_name

Results = Mapping[str, Result]


def speed(results: Results) -> str:
    """Return median and 95th percentile over people and cameras [ms]."""
    cameras, people, at = grid(results)
    rows = [
        [str(p), *(f"{number(at(c, p, 'median'))} / {number(at(c, p, 'p95'))}" for c in cameras)]
        for p in people
    ]
    return table(["people", *(f"{c} cameras" for c in cameras)], rows) + busy(results["speed"])


def speed_short(results: Results) -> str:
    """Return the medians of a few sites [ms]."""
    _, _, at = grid(results)
    lensed = partial(value_of, results["speed"].figures, LENSED)
    sites = ((2, 3), (4, 4), (4, 10), (12, 10), (12, 50))
    rows = [
        ["fusion per frame set, median [ms]", *(number(at(c, p, "median")) for c, p in sites)],
        ["95th percentile [ms]", *(number(at(c, p, "p95")) for c, p in sites)],
    ]
    if LENSED in results["speed"].figures:
        rows.append(
            [
                "median, cameras with lenses that distort [ms]",
                *(number(lensed(cell_name(c, p), "median")) for c, p in sites),
            ]
        )
    made = table(["cameras x people", *(f"{c} x {p}" for c, p in sites)], rows)
    return made + busy(results["speed"])


def pipeline_short(results: Results) -> str:
    """Return what a site costs: 2D poses by the processor's vector instructions, and the rest."""
    result = results["estimator_speed"]
    per_image = partial(value_of, result.figures)
    ms = (
        per_image("per image", "two people", "median"),
        per_image("per image, in 32 bits", "two people", "median"),
        ESTIMATOR_AVX2_MS,
    )
    cost = results["pipeline_cost"].figures if "pipeline_cost" in results else {}
    total = value_of(cost, "whole pipeline / estimation alone", "processor time")
    memory = number(value_of(cost, "peak memory", "8 s of video"))
    rows = [
        ["2D pose model, one image on one core [ms]", *map(number, ms)],
        [
            "cores for 4 cameras at 25 images per second, model alone",
            *(number(one / 10, 2) for one in ms),
        ],
        [
            "whole pipeline / decoding, scaling and model, processor time",
            *(number(total), NOTHING, NOTHING),
        ],
        ["peak memory, 4 cameras of 1920 x 1080 [MB]", memory, NOTHING, NOTHING],
    ]
    head = ["vector instructions", "bfloat16", "AVX-512, 32 bits", "AVX2 alone (recorded)"]
    return table(head, rows) + busy(result)


def live_short(results: Results) -> str:
    """Return what a live site of four cameras reaches."""
    result = results["live"]
    named = {
        "images per second through the whole site": ("images fused", 2),
        "of what the 2D pose model alone reaches with all cores [%]": ("of the estimator alone", 2),
        "image to program, median [ms]": ("image to program, median", 3),
        "of which the 2D pose model [ms]": ("estimate, median", 2),
    }
    rows = [
        [text, number(value_of(result.figures, name), digits)]
        for text, (name, digits) in named.items()
    ]
    return table(["4 RTSP cameras, 720 x 1280 px, 20 images/s, two cores", ""], rows) + busy(result)


def thesis_speed(results: Results) -> str:
    """Return the thesis' table 5 [ms] with ours beside it."""
    _, people, at = grid(results)
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
    return table(head, rows) + busy(results["speed"])


def thesis_rate(results: Results) -> str:
    """Return the thesis' table 6, frame sets per second, with ours beside it."""
    _, people, at = grid(results)
    rows = [
        [str(p), fixed(1e3 / at(2, p, "mean"), 0), fixed(1e3 / at(2, p, "max"), 0),
         fixed(1e3 / THESIS_FIT_MS[p][0], 0) if p in THESIS_FIT_MS else NOTHING,
         fixed(1e3 / THESIS_FIT_MS[p][2], 0) if p in THESIS_FIT_MS else NOTHING]
        for p in people if p <= 10
    ]  # fmt: skip
    head = ["people", "per second", "in the slowest", "thesis: per second", "in the slowest"]
    return table(head, rows)


def beside_author(_: Results) -> str:
    """Return ours beside the thesis author's program, cell by cell; recorded in one run."""
    rows = []
    for cell in BESIDE_AUTHOR:
        least, most = cell.theirs_ms
        rows.append(
            [cell.scene, number(cell.ours_ms), f"{number(least)} to {number(most)}",
             f"{fixed(least / cell.ours_ms, 0)} to {fixed(most / cell.ours_ms, 0)}", cell.built]
        )  # fmt: skip
    head = ["thesis' scene", "trecsim [ms]", "author's program [ms]", "ratio", "built with"]
    return table(head, rows)


def beside_pose2sim(results: Results) -> str:
    """Return ours beside Pose2Sim, cell by cell, measured in one run."""
    result = results["beside_pose2sim"]
    rows = []
    for name in result.figures:
        at = partial(value_of, result.figures, name)
        rows.append(
            [name, number(at("trecsim, from the files on")), number(at("trecsim, fusion alone")),
             number(at("Pose2Sim, second call")),
             fixed(at("Pose2Sim / trecsim, from the files on"), 0),
             fixed(at("Pose2Sim / trecsim's fusion"), 0)]
        )  # fmt: skip
    head = ["recording", "trecsim, files to people [ms]", "of it fusion [ms]",
            f"Pose2Sim {result.about['input']['pose2sim']}, files to people [ms]",
            "ratio, files to people", "ratio to the fusion alone"]  # fmt: skip
    told = "Processor time per frame set, both one thread, warm."
    return f"{table(head, rows)}\n\nOn {machine_of(result)}. {told}{busy(result)}"


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
    for group in ("per image", "per image, in 32 bits"):
        for people, name in ((1, "one person"), (2, "two people")):
            at = partial(value_of, result.figures, group, name)
            ours = _mean_std(at("mean"), at("std"), at("max"), at("min"))
            rows.append(
                [f"{name}{group.removeprefix('per image')}", *ours, fixed(1e3 / at("mean"), 0),
                 *(_recorded(THESIS_INFERENCE_MS[people]) if group == "per image"
                   else [NOTHING] * 3)]
            )  # fmt: skip
    median = number(ESTIMATOR_AVX2_MS)
    rows.append([f"two people, avx2 alone (recorded, median {median})", *[NOTHING] * 3,
                 fixed(1e3 / ESTIMATOR_AVX2_MS, 0), *[NOTHING] * 3])  # fmt: skip
    head = ["in the image", "mean ± std [ms]", "max", "min", "images per second",
            "thesis (YOLOv7, GPU): mean ± std [ms]", "max", "min"]  # fmt: skip
    return table(head, rows) + f"\n\nOn {machine_of(result)}. Processor time." + busy(result)


def grid(results: Results) -> tuple[list[int], list[int], Callable[[int, int, str], float]]:
    """Return the numbers of cameras and people that were timed, and how to look a time up."""
    cells = results["speed"].figures["per frame set"]
    assert isinstance(cells, Mapping)
    counts = [tuple(int(word) for word in name.split() if word.isdigit()) for name in cells]

    def at(cameras: int, people: int, name: str) -> float:
        return value_of(cells, cell_name(cameras, people), name)

    return sorted({c for c, _ in counts}), sorted({p for _, p in counts}), at
