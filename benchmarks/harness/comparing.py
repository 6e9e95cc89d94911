"""What got worse beyond noise? The rule is explained in ``benchmarks/README.md``."""

import math
import statistics
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from harness.figures import Figure, Path_, Result, find, leaves, spread_of
from harness.machine import crowded

Verdict = Literal["worse", "better", "as before"]

# Student's t, one-sided 99 %, by degrees of freedom.
STUDENT = (math.inf, 31.8, 6.96, 4.54, 3.75, 3.36, 3.14, 3.0, 2.9, 2.82, 2.76)
STUDENT_MANY = 2.6
COUNTED = 1.65  # one-sided 95 % of a difference of two counts
SMALL = 0.01  # a mean that moved by less than this share is as before
SMALL_ONCE = 0.03  # the same for what is measured once
SMALL_TIME = 0.20  # a time, relative to the calibration
GAPS = 2.0  # so many times the gaps between the two best rounds of both
ALONE = 0.10  # such a gap where there is a single round


@dataclass(frozen=True, slots=True)
class Change:
    """How a figure moved.

    Attributes
    ----------
    path
        Names of its groups and its own.
    verdict
        Whether it moved beyond noise, and which way.
    before, now
        Values, over the runs both have in common; of times: those quoted.
    noise
        What it might have moved by chance, in the unit; of times: as a share.
    unit
        Of the values.
    moved
        Of times: by which share, relative to the calibration.
    """

    path: Path_
    verdict: Verdict
    before: float
    now: float
    noise: float
    unit: str
    moved: float | None = None

    def __str__(self) -> str:
        """Return one line."""
        what = " / ".join(self.path)
        unit = f" {self.unit}" if self.unit else ""
        if self.moved is not None:
            return (
                f"{what}: {self.before:.3g} -> {self.now:.3g}{unit}; relative to the calibration "
                f"{100 * self.moved:+.0f} % (noise {100 * self.noise:.0f} %)"
            )
        return f"{what}: {self.before:.4g} -> {self.now:.4g}{unit} (noise {self.noise:.2g})"


def compare(now: Result, before: Result) -> list[Change]:
    """Return how every figure moved that both results have and that is watched."""
    return list(_changes(now, before, same_input(now, before)))


def same_input(now: Result, before: Result) -> bool:
    """Tell whether what is made on the way is the same, as far as both have it."""
    one, other = (result.about.get("fingerprints", {}) for result in (now, before))
    return all(other[name] == print_ for name, print_ in one.items() if name in other)


def times_count(now: Result, before: Result) -> bool:
    """Tell whether both had a core to themselves; else times say nothing."""
    return not (crowded(now.about) or crowded(before.about))


def _changes(now: Result, before: Result, paired: bool) -> Iterator[Change]:
    times = times_count(now, before)
    for path, figure in leaves(now.figures):
        if figure.kind == "time" and not times:
            continue
        old = find(before.figures, path)
        if old is None or not figure.watched or not math.isfinite(old.value):
            continue
        if not math.isfinite(figure.value):
            yield Change(path, "worse", old.value, figure.value, 0.0, figure.unit)
        elif figure.kind == "time" and figure.relative and old.relative:
            yield _compare_times(path, figure, old)
        else:
            yield _compare_values(path, figure, old, paired)


def _compare_times(path: Path_, now: Figure, before: Figure) -> Change:
    moved = min(now.relative) / min(before.relative) - 1.0
    noise = max(SMALL_TIME, GAPS * (_gap(now.relative) + _gap(before.relative)))
    verdict = _verdict(moved, noise)
    return Change(path, verdict, before.value, now.value, noise, now.unit, moved)


def _gap(relative: tuple[float, ...]) -> float:
    """Return by which share the second best round took longer than the best."""
    best = sorted(relative)[:2]
    return best[1] / best[0] - 1.0 if len(best) > 1 else ALONE


def _compare_values(path: Path_, now: Figure, before: Figure, paired: bool) -> Change:
    common = [run for run in now.runs if run in before.runs] if paired else []
    common = [run for run in common if math.isfinite(now.runs[run] + before.runs[run])]
    if now.kind == "sum":
        old, new = _sums(now, before, common)
        noise = COUNTED * math.sqrt(max(old, 0.0) + max(new, 0.0))
    elif common:
        pairs = [(before.runs[run], now.runs[run]) for run in common]
        old, new = (statistics.fmean(values) for values in zip(*pairs, strict=True))
        noise = _paired_noise([b - a for a, b in pairs])
    else:
        old, new = before.value, now.value
        noise = _unpaired_noise(now, before)
    matters = now.matters
    if matters is None and now.kind != "sum":
        matters = (SMALL_ONCE if now.kind == "once" else SMALL) * abs(old)
    noise = max(noise, matters or 0.0)
    worse = new - old if now.better == "lower" else old - new
    return Change(path, _verdict(worse, noise), old, new, noise, now.unit)


def _sums(now: Figure, before: Figure, common: list[str]) -> tuple[float, float]:
    if common:
        return sum(before.runs[run] for run in common), sum(now.runs[run] for run in common)
    share = len(now.runs) / max(len(before.runs), 1)  # a subset has fewer seeds
    return before.value * share, now.value


def _paired_noise(differences: list[float]) -> float:
    """Return how far the mean of paired differences may be from nothing by chance."""
    n = len(differences)
    if n < 2:
        return 0.0
    return _student(n - 1) * spread_of(differences) / math.sqrt(n)


def _unpaired_noise(now: Figure, before: Figure) -> float:
    """Return how far two means of different input may be apart by chance."""
    variance, freedom = 0.0, 0
    for figure in (now, before):
        n = len(figure.runs)
        if n > 1:
            variance += figure.spread**2 / n
            freedom += n - 1
    return _student(freedom) * math.sqrt(variance) if freedom else 0.0


def _student(freedom: int) -> float:
    return STUDENT[freedom] if freedom < len(STUDENT) else STUDENT_MANY


def _verdict(worse: float, noise: float) -> Verdict:
    if worse > noise:
        return "worse"
    return "better" if -worse > noise else "as before"
