"""Analysis of the finished runs of a study, measure by measure."""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.errors import InputError
from trecsim.lab.study.code_digest import code_digest
from trecsim.lab.study.default_rank import DefaultRank, default_rank
from trecsim.lab.study.design import Design, Factor, Point, Value, levels_of, value_text
from trecsim.lab.study.inference import Analysis, analyse
from trecsim.lab.study.plan import Study
from trecsim.lab.study.resampling import Blocks, blocks_of
from trecsim.lab.study.running import jobs_of
from trecsim.lab.study.runs_file import Run

FEW_SEEDS = 5
_ENOUGH = 0.5  # share of finished points from which a scene and seed counts


@dataclass(frozen=True, slots=True)
class Measure:
    """One figure by which settings are compared.

    Attributes
    ----------
    name
        As in tables.
    title, short
        For people, long and short.
    unit
        Of its values.
    digits
        After the decimal point.
    more_is_better
        Whether large values are good.
    of
        Takes it from the figures of a run.
    """

    name: str
    title: str
    short: str
    unit: str
    digits: int
    more_is_better: bool
    of: Callable[[Mapping[str, float]], float]


def _lost_percent(figures: Mapping[str, float]) -> float:
    there = figures["person_frames"]
    return 100.0 * (figures["missed"] + figures["ghosts"]) / there if there else math.nan


MEASURES = (
    Measure(
        "error_cm", "mean error of the joints", "error", "cm", 2, False, lambda f: 100 * f["mean_m"]
    ),
    Measure(
        "recall_percent", "joints within 15 cm", "within 15 cm", "%", 2, True,
        lambda f: 100 * f["recall_15cm"],
    ),
    Measure(
        "switches", "identity switches per scene", "switches", "", 2, False,
        lambda f: f["switches"],
    ),
    Measure(
        "lost_percent", "missed people and false positives", "missed, false", "%", 2, False,
        _lost_percent,
    ),
    Measure(
        "fusion_ms", "fusion per frame set", "time", "ms", 2, False, lambda f: f["fusion_ms"]
    ),
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """Findings about one measure.

    Attributes
    ----------
    measure
        Which.
    levels
        Of each setting: the values, or means of the parts where values were drawn.
    analysis
        Effects of settings and pairs.
    default_rank
        Rank of the default; None if it has no complete results.
    points
        Points that `default_rank` numbers.
    mean
        Their outcomes, all scenes and seeds together.
    """

    measure: Measure
    levels: tuple[tuple[Value, ...], ...]
    analysis: Analysis
    default_rank: DefaultRank | None
    points: tuple[Point, ...]
    mean: Float64[np.ndarray, " point"]


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """Findings of a study.

    Attributes
    ----------
    factors
        The settings that were tried.
    findings
        One per measure.
    code
        Version of the code that the runs were made with.
    runs, wanted
        How many runs are there, and how many the study has.
    failed
        Reasons why runs failed, with how many.
    remarks
        Remarks on the validity of the figures.
    """

    factors: tuple[Factor, ...]
    findings: tuple[Finding, ...]
    code: str
    runs: int
    wanted: int
    failed: Mapping[str, int]
    remarks: tuple[str, ...]


def findings(study: Study, runs: Sequence[Run], code: str) -> Findings:
    """Analyse the finished runs of one version of the code; other runs are left out.

    Raises
    ------
    InputError
        There are too few runs.
    """
    names = [factor.name for factor in study.design.factors]
    blocks = {(scene.name, seed): n for n, (scene, seed) in enumerate(study.blocks)}
    numbered: dict[tuple[object, ...], int] = {p: n for n, p in enumerate(study.design.points)}
    table = np.full((len(MEASURES), len(blocks), len(numbered)), np.nan)
    own: dict[tuple[int, int], Run] = {}
    for run in _of_this_study(study, runs, code):
        block = blocks.get((run.scene, run.seed))
        point = numbered.get(tuple(run.values.get(name) for name in names))
        if block is not None and point is not None:
            own[block, point] = run
    for (block, point), run in own.items():
        if not run.fault:
            table[:, block, point] = [measure.of(run.figures) for measure in MEASURES]
    failed = Counter(run.fault for run in own.values() if run.fault)
    count = len(own)
    remarks: list[str] = []
    found = tuple(_finding(measure, table[m], study, remarks) for m, measure in enumerate(MEASURES))
    wanted = study.runs
    if count < wanted:
        remarks.insert(0, f"{wanted - count} of {wanted} runs are not done yet.")
    if few := few_seeds(study):
        remarks.append(few)
    if not all(scene.is_simulated for scene in study.scenes):
        remarks.append(
            "Scenes that were not simulated have no seeds: their noise is not in the intervals."
        )
    told = tuple(dict.fromkeys(remarks))
    return Findings(study.design.factors, found, code, count, wanted, dict(failed), told)


def _of_this_study(study: Study, runs: Sequence[Run], code: str) -> list[Run]:
    """Return the runs that count; those of an older version are matched by their values only."""
    same = [run for run in runs if run.code == code]
    if code != code_digest():
        return same
    keys = {job.key for job in jobs_of(study, Path())}
    return [run for run in same if run.key in keys]


def few_seeds(study: Study) -> str:
    """Return a warning if a study has too few seeds; else an empty text."""
    count = len(study.seeds)
    if count >= FEW_SEEDS or not any(scene.is_simulated for scene in study.scenes):
        return ""
    return f"only {count} seed{'s' if count > 1 else ''}: use at least {FEW_SEEDS}"


def _finding(
    measure: Measure,
    outcome: Float64[np.ndarray, "block point"],
    study: Study,
    remarks: list[str],
) -> Finding:
    block, point = _complete(outcome)
    design = study.design
    own = np.array(design.own) & point
    if block.sum() < 1 or own.sum() < 2:
        raise InputError(
            f"too few finished runs for the {measure.title}: no two points are complete on the "
            "same scene and seed; let the study continue"
        )
    if not block.all():
        remarks.append(
            f"{int((~block).sum())} of {len(block)} scenes and seeds are incomplete and excluded."
        )
    if not point.all():
        remarks.append(
            f"{measure.title}: {int((~point).sum())} of {len(point)} points are excluded because a "
            "run failed or had no match: "
            + "; ".join(named(design.factors, p) for p in _those(design.points, ~point)[:3])
        )
    scene_names = [scene.name for scene, _ in study.blocks]
    seeds = [scene.name if seed is None else seed for scene, seed in study.blocks]
    weights = blocks_of(np.unique(np.array(scene_names)[block], return_inverse=True)[1])
    full = outcome[np.ix_(block, point)]
    stands = None
    if point[0]:
        kept_seeds = [seed for seed, there in zip(seeds, block, strict=True) if there]
        better = measure.more_is_better
        stands = default_rank(full, kept_seeds, weights, 0, more_is_better=better)
    levels, analysis = _analysis(outcome[np.ix_(block, own)], own, design, weights)
    return Finding(
        measure, levels, analysis, stands, _those(design.points, point), weights.weight @ full
    )


def _analysis(
    outcome: Float64[np.ndarray, "block point"],
    own: Bool[np.ndarray, " point"],
    design: Design,
    weights: Blocks,
) -> tuple[tuple[tuple[Value, ...], ...], Analysis]:
    points = _those(design.points, own)
    single = design.kind == "one-at-a-time"
    if single and design.points[0] not in points:
        raise InputError(
            "a run of the default failed, so the one-at-a-time design has no reference"
        )
    level, levels = levels_of(design, points)
    return levels, analyse(
        outcome,
        level,
        weights,
        [_reference(f, values) for f, values in zip(design.factors, levels, strict=True)],
        balanced=single or (design.kind == "grid" and len(points) == sum(design.own)),
        anchor=0 if single else None,
        interactions=not single,
    )


def _those(points: Sequence[Point], which: Bool[np.ndarray, " point"]) -> tuple[Point, ...]:
    return tuple(point for point, there in zip(points, which, strict=True) if there)


def _complete(
    outcome: Float64[np.ndarray, "block point"],
) -> tuple[Bool[np.ndarray, " block"], Bool[np.ndarray, " point"]]:
    """Return which scenes and seeds, and which points, make a table without gaps."""
    known = np.isfinite(outcome)
    block = known.mean(axis=1) >= _ENOUGH
    return block, known[block].all(axis=0) if block.any() else np.zeros(known.shape[1], bool)


def named(factors: Sequence[Factor], point: Point) -> str:
    """Return a point as a person reads it."""
    return ", ".join(
        f"{f.name} = {value_text(value)}" for f, value in zip(factors, point, strict=True)
    )


def _reference(factor: Factor, levels: Sequence[Value]) -> Float64[np.ndarray, " level"]:
    """Return which level stands for the default: itself, a place between two, or all alike."""
    weights = np.zeros(len(levels))
    if factor.default in levels:
        weights[levels.index(factor.default)] = 1.0
        return weights
    if not lies_within(factor, levels):
        return np.full(len(levels), 1.0 / len(levels))
    numbers = [float(level) for level in levels]
    default = float(factor.default)
    if factor.log:
        numbers, default = [math.log(number) for number in numbers], math.log(default)
    above = int(np.searchsorted(numbers, default))
    share = (default - numbers[above - 1]) / (numbers[above] - numbers[above - 1])
    weights[above - 1], weights[above] = 1.0 - share, share
    return weights


def lies_within(factor: Factor, levels: Sequence[Value]) -> bool:
    """Tell whether the default of a setting can be compared with the values that were tried."""
    if factor.default in levels:
        return True
    if any(isinstance(value, bool | str) for value in (*levels, factor.default)):
        return False
    return float(levels[0]) < float(factor.default) < float(levels[-1])
