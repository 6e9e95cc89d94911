"""The command `trecsim evaluate-events`."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trecsim.cli.terminal import finish
from trecsim.errors import InputError

if TYPE_CHECKING:
    from trecsim.lab.evaluation.event_scores import EventEvaluation, EventScores


def evaluate_events(
    events: Path, /, *, truth: Path, camera_days: float | None = None, json: bool = False
) -> None:
    """Evaluate events of rules against true events.

    An episode is right if a true one of the same rule, and direction, began at most 2 s after or
    10 s before it; each counts once.

    Parameters
    ----------
    events
        Events as `trecsim assess` writes them.
    truth
        The true events, in the same form.
    camera_days
        Length of what was watched, times the number of cameras [days]: tells false alarms per
        camera and day.
    json
        Print all scores as one JSON object.
    """
    from trecsim.lab.evaluation.event_scores import evaluate_events as run

    if camera_days is not None and not camera_days > 0.0:
        raise InputError(f"--camera-days: expected more than 0, found {camera_days:g}")
    result = run(events, truth)
    summary = {
        "events": events,
        "truth": truth,
        "kinds": {kind: _scores(scores, camera_days) for kind, scores in result.kinds.items()},
        "all": {**_scores(result.total, camera_days), "macro_f1": result.macro_f1},
        "warnings": result.warnings,
        "early": result.early.row(),
    }
    finish(summary, json, "\n".join([_table(result), *_more(result, camera_days)]))


def _scores(scores: "EventScores", camera_days: float | None) -> dict[str, Any]:
    row = scores.row()
    if camera_days is not None:
        row["false_per_camera_day"] = (scores.told - scores.right) / camera_days
    return row


def _more(result: "EventEvaluation", camera_days: float | None) -> Iterator[str]:
    """Yield lines about false alarms and early warnings."""
    if camera_days is not None:
        false = result.total.told - result.total.right
        yield f"false alarms: {false / camera_days:.2f} per camera and day"
    early = result.early
    if not early.given:
        return
    lead = f", {early.row()['lead_s']:.2f} s before (median)" if early.leads_s else ""
    yield (
        f"early warnings: {early.given}, of which {early.came_true} came true{lead}; "
        f"{early.unwarned} happened without one"
    )
    for one in early.horizons:
        if one.count:
            yield (
                f"  within {one.within_s:g} s: told {100 * one.told:.0f} %, "
                f"happened {100 * one.happened:.0f} %, Brier score {one.brier:.3f}"
            )


def _table(result: "EventEvaluation") -> str:
    head = ("kind", "told", "true", "right", "precision", "recall", "F1", "onset s", "latency s")
    rows = [head, *(_row(kind, scores) for kind, scores in result.kinds.items())]
    rows.append(_row("all", result.total))
    widths = [max(len(row[column]) for row in rows) for column in range(len(head))]
    return "\n".join(
        "  ".join(
            [
                row[0].ljust(widths[0]),
                *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True)),
            ]
        )
        for row in rows
    )


def _row(name: str, scores: "EventScores") -> tuple[str, ...]:
    row = scores.row()
    shares = (scores.precision, scores.recall, scores.f1)
    times = (row["onset_error_s"]["median"], row["latency_s"]["median"])
    numbers = [*(f"{one:.3f}" for one in shares), *(f"{one:+.2f}" for one in times)]
    counts = (str(scores.told), str(scores.true), str(scores.right))
    shown = [
        "-" if math.isnan(one) else text
        for one, text in zip((*shares, *times), numbers, strict=True)
    ]
    return (name, *counts, *shown)
