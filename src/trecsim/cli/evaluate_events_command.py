"""The command `trecsim evaluate-events`."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.cli.terminal import finish

if TYPE_CHECKING:
    from trecsim.lab.evaluation.event_scores import EventEvaluation, EventScores


def evaluate_events(events: Path, /, *, truth: Path, json: bool = False) -> None:
    """Evaluate events of rules against true events.

    An episode is right if a true one of the same rule, and direction, began at most 2 s after or
    10 s before it; each counts once.

    Parameters
    ----------
    events
        Events as `trecsim assess` writes them.
    truth
        The true events, in the same form.
    json
        Print all scores as one JSON object.
    """
    from trecsim.lab.evaluation.event_scores import evaluate_events as run

    result = run(events, truth)
    summary = {
        "events": events,
        "truth": truth,
        "kinds": {kind: scores.row() for kind, scores in result.kinds.items()},
        "all": {**result.total.row(), "macro_f1": result.macro_f1},
        "warnings": result.warnings,
    }
    finish(summary, json, _table(result))


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
