"""Scores of forecasts as a summary and as text."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from trecsim.store.ethucy import SETS, TRUE_TIME

if TYPE_CHECKING:
    from trecsim.forecasting.path_scores import Scores

NOTE = (
    "8 samples observed (3.2 s), 12 forecast (4.8 s), 0.4 s apart; best of 20: least ADE and least "
    "FDE of 20 paths, each by itself"
)

HEADER = (
    "set", "samples", "ADE/FDE m", "constant velocity", "best of 20",
    "coverage at 50, 80, 90, 95 %", "whole path", "NLL",
)  # fmt: skip


def summary_of(scores: "Mapping[str, Scores]") -> dict[str, Any]:
    """Return the mean over the sets, each set, and, for ETH/UCY, the mean in true time."""
    sets = {name: one.summary() for name, one in scores.items()}
    published = [name for name in sets if name != TRUE_TIME or "eth" not in sets]
    summary = {**_mean([sets[name] for name in published]), "protocol": NOTE, "sets": sets}
    if set(SETS) <= set(sets):
        timely = [name for name in sets if name != "eth"]
        summary["true_time"] = _mean([sets[name] for name in timely])
    return summary


def score_text(summary: Mapping[str, Any]) -> str:
    """Return the summary as a table."""
    rows: list[tuple[str, ...]] = [HEADER]
    rows += [_row(name, one) for name, one in summary["sets"].items()]
    if len(summary["sets"]) > 1:
        rows.append(_row("mean", summary))
    if "true_time" in summary:
        rows.append(_row("mean, true time", summary["true_time"]))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["  ".join(text.ljust(w) for text, w in zip(row, widths, strict=True)) for row in rows]
    return "\n".join([*(line.rstrip() for line in lines), "", summary["protocol"]])


def _row(name: str, one: Mapping[str, Any]) -> tuple[str, ...]:
    constant, best = one["constant_velocity"], one["best_of_20"]
    coverage = " ".join(f"{share:.3f}" for share in one["coverage"].values())
    whole = " ".join(f"{share:.3f}" for share in one["whole_path_coverage"].values())
    return (
        name, str(one["samples"]), _pair(one), _pair(constant), _pair(best), coverage, whole,
        f"{one['nll']:.3f}",
    )  # fmt: skip


def _pair(one: Mapping[str, float]) -> str:
    return f"{one['ade_m']:.3f}/{one['fde_m']:.3f}"


def _mean(sets: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the plain mean over the sets of every number; the sum of the samples."""
    if not sets:
        return {}
    return {
        key: sum(one[key] for one in sets) if key == "samples" else _mean_of([s[key] for s in sets])
        for key in sets[0]
    }


def _mean_of(values: Sequence[Any]) -> Any:
    if isinstance(values[0], Mapping):
        return {key: _mean_of([value[key] for value in values]) for key in values[0]}
    return sum(values) / len(values)
