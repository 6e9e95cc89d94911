"""Figures with unit, direction and spread, nested in groups; and the results that hold them."""

import json
import math
import statistics
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

FORMAT = "trecsim.benchmark/1"
RESULTS = Path(__file__).resolve().parents[1] / "results"

Better = Literal["lower", "higher"]
Kind = Literal["mean", "sum", "time", "once"]
Path_ = tuple[str, ...]


class Skipped(Exception):  # noqa: N818  it is no error
    """A benchmark cannot run here; the text says why."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure.

    Attributes
    ----------
    value
        What is quoted; NaN where nothing could be measured.
    unit
        Of the value; empty for a pure number.
    better
        Which way is better.
    kind
        ``mean`` over the runs, ``sum`` over the runs, ``time`` (median over the rounds, compared
        relative to the calibration workload) or ``once`` (no spread).
    runs
        The value of each seed or round.
    relative
        Times only: each round's processor time divided by the calibration workload's in that round.
    matters
        Least change that is worth naming, in the unit; None: the rule's own (see `comparing`).
    watched
        Whether the comparison looks at it.
    """

    value: float
    unit: str
    better: Better
    kind: Kind
    runs: Mapping[str, float] = field(default_factory=dict)
    relative: tuple[float, ...] = ()
    matters: float | None = None
    watched: bool = True

    @property
    def spread(self) -> float:
        """Standard deviation over the runs; NaN where there are fewer than two."""
        return spread_of(list(self.runs.values()))


Figures = Mapping[str, "Figure | Figures"]


def spread_of(values: Sequence[float]) -> float:
    """Return the standard deviation of a sample; NaN where there are fewer than two values.

    Examples
    --------
    >>> spread_of([1.0, 3.0])
    1.4142135623730951
    """
    finite = [value for value in values if math.isfinite(value)]
    return statistics.stdev(finite) if len(finite) > 1 else math.nan


def _mean(values: Sequence[float]) -> float:
    finite = [value for value in values if math.isfinite(value)]
    return statistics.fmean(finite) if finite else math.nan


def over_seeds(
    runs: Mapping[Any, float], unit: str, better: Better = "lower", matters: float | None = None
) -> Figure:
    """Return the mean over seeds."""
    by_name = {str(seed): float(value) for seed, value in runs.items()}
    return Figure(_mean(list(by_name.values())), unit, better, "mean", by_name, matters=matters)


def summed(runs: Mapping[Any, float], unit: str = "", better: Better = "lower") -> Figure:
    """Return the sum over seeds, of things that are counted."""
    by_name = {str(seed): float(value) for seed, value in runs.items()}
    return Figure(sum(by_name.values()), unit, better, "sum", by_name)


def timed(
    rounds: Sequence[float],
    calibration: Sequence[float],
    unit: str = "ms",
    *,
    used: Sequence[float] | None = None,
    watched: bool = True,
) -> Figure:
    """Return the median over rounds of something timed.

    Parameters
    ----------
    rounds
        Wall time of each; their median is quoted.
    calibration
        What `calibration_ms` said in each.
    unit
        Of the rounds.
    used
        Processor time of each round, which is what is compared; the wall time, if None.
    watched
        Whether the comparison looks at it.
    """
    by_name = {str(number): float(value) for number, value in enumerate(rounds, start=1)}
    relative = tuple(t / c for t, c in zip(used or rounds, calibration, strict=True))
    value = statistics.median(rounds)
    return Figure(value, unit, "lower", "time", by_name, relative, watched=watched)


def once(
    value: float,
    unit: str,
    better: Better = "lower",
    matters: float | None = None,
    *,
    watched: bool = True,
) -> Figure:
    """Return something measured once, on the same input every time."""
    return Figure(float(value), unit, better, "once", matters=matters, watched=watched)


def leaves(figures: Figures, above: Path_ = ()) -> Iterator[tuple[Path_, Figure]]:
    """Yield all figures, each with the names of its groups and its own."""
    for name, inside in figures.items():
        if isinstance(inside, Figure):
            yield (*above, name), inside
        else:
            yield from leaves(inside, (*above, name))


def find(figures: Figures, path: Path_) -> Figure | None:
    """Return the figure at a path of names, or None where there is none."""
    inside: Figure | Figures | None = figures
    for name in path:
        if inside is None or isinstance(inside, Figure):
            return None
        inside = inside.get(name)
    return inside if isinstance(inside, Figure) else None


@dataclass(frozen=True, slots=True)
class Result:
    """What one benchmark measured, and where, when and with what.

    Attributes
    ----------
    name
        Of the benchmark.
    figures
        Nested groups of figures.
    about
        Machine, versions, commit, date, input, settings that were overridden, calibration.
    skipped
        Parts that could not run, and why.
    """

    name: str
    figures: Figures
    about: Mapping[str, Any]
    skipped: Mapping[str, str] = field(default_factory=dict)


def _number(value: float) -> float | None:
    """Return four to five significant digits, so that stored results can be read; NaN as None."""
    return float(f"{value:.5g}") if math.isfinite(value) else None


def _from_number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _figure_to_json(figure: Figure) -> dict[str, Any]:
    out: dict[str, Any] = {
        "value": _number(figure.value),
        "unit": figure.unit,
        "better": figure.better,
        "kind": figure.kind,
    }
    if figure.runs:
        out["spread"] = _number(figure.spread)
        out["runs"] = {name: _number(value) for name, value in figure.runs.items()}
    if figure.relative:
        out["relative"] = [_number(value) for value in figure.relative]
    if figure.matters is not None:
        out["matters"] = figure.matters
    if not figure.watched:
        out["watched"] = False
    return out


def _to_json(figures: Figures) -> dict[str, Any]:
    return {
        name: _figure_to_json(inside) if isinstance(inside, Figure) else _to_json(inside)
        for name, inside in figures.items()
    }


def _from_json(figures: Mapping[str, Any]) -> dict[str, Any]:
    return {
        name: _figure_from_json(inside) if "kind" in inside else _from_json(inside)
        for name, inside in figures.items()
    }


def _figure_from_json(stored: Mapping[str, Any]) -> Figure:
    return Figure(
        value=_from_number(stored["value"]),
        unit=stored["unit"],
        better=stored["better"],
        kind=stored["kind"],
        runs={name: _from_number(value) for name, value in stored.get("runs", {}).items()},
        relative=tuple(_from_number(value) for value in stored.get("relative", ())),
        matters=stored.get("matters"),
        watched=stored.get("watched", True),
    )


def to_json(result: Result) -> str:
    """Return a result as text."""
    whole = {
        "format": FORMAT,
        "name": result.name,
        "about": dict(result.about),
        "skipped": dict(result.skipped),
        "figures": _to_json(result.figures),
    }
    return _laid_out(whole) + "\n"


def _laid_out(value: Any, depth: int = 0) -> str:
    """Return JSON with one line for each figure."""
    if not isinstance(value, dict) or not any(isinstance(v, dict) for v in value.values()):
        return json.dumps(value, allow_nan=False)
    if "kind" in value:
        return json.dumps(value, allow_nan=False)
    inside = ",\n".join(
        f"{' ' * (depth + 1)}{json.dumps(name)}: {_laid_out(part, depth + 1)}"
        for name, part in value.items()
    )
    return f"{{\n{inside}\n{' ' * depth}}}"


def from_json(text: str) -> Result:
    """Return a result from text."""
    whole = json.loads(text)
    if whole.get("format") != FORMAT:
        raise ValueError(f"expected a result of format {FORMAT!r}, got {whole.get('format')!r}")
    return Result(whole["name"], _from_json(whole["figures"]), whole["about"], whole["skipped"])


def store(result: Result, path: Path) -> None:
    """Write a result, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_suffix(".part")
    beside.write_text(to_json(result), encoding="utf-8")
    beside.replace(path)


def stored(name: str, folder: Path = RESULTS) -> Result | None:
    """Return the last stored result of a benchmark, or None where there is none."""
    path = folder / f"{name}.json"
    return from_json(path.read_text(encoding="utf-8")) if path.exists() else None
