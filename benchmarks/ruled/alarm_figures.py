"""Figures of a while in which nothing much happens: false alarms per camera-day, and warnings."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from harness.figures import Figures, once
from ruled.warnings_told import Warned, brier, median_lead_s

if TYPE_CHECKING:
    from trecsim.lab.evaluation.event_scores import EventScores

DAY_S = 86400.0
BORDERS = ("zone.enter", "zone.exit", "line.cross", "zone.dwell")
"""Rules that people who walk about fulfil all the time, often by a centimetre."""


def alarm_figures(kinds: "Mapping[str, EventScores]", camera_days: float) -> Figures:
    """Return what was told that is not true, and the reverse; borders apart.

    Parameters
    ----------
    kinds
        Scores by kind of rule.
    camera_days
        Length times the number of cameras.
    """
    alarms = [one for kind, one in kinds.items() if kind not in BORDERS]
    borders = [one for kind, one in kinds.items() if kind in BORDERS]
    false = sum(one.told - one.right for one in alarms)
    return {
        "borders: true episodes": once(sum(one.true for one in borders), "", watched=False),
        "borders: invented": once(sum(one.told - one.right for one in borders), "", matters=0.0),
        "borders: missed": once(sum(one.true - one.right for one in borders), "", matters=0.0),
        "other rules: true episodes": once(sum(one.true for one in alarms), "", watched=False),
        "false alarms": once(false, "", matters=0.0),
        "missed": once(sum(one.true - one.right for one in alarms), "", matters=0.0),
        "false alarms by rule": {
            kind: once(one.told - one.right, "", matters=0.0)
            for kind, one in kinds.items()
            if one.told > one.right
        },
        "false alarms per camera-day": once(false / camera_days, "", watched=False),
        # Of rare independent events: if none was seen, the rate is below 3 over the time, 19 of 20.
        "surely below, per camera-day": once(
            (false + 3.0 + 1.7 * false**0.5) / camera_days, "", watched=False
        ),
        "alarms of falls and people down": once(
            sum(kinds[kind].told for kind in ("body.fall", "body.down") if kind in kinds),
            "", matters=0.0,
        ),
    }  # fmt: skip


def warning_figures(warned: Sequence[Warned], camera_days: float) -> Figures:
    """Return how many early warnings were given, and what came of them."""
    false = sum(not one.came_true for one in warned)
    return {
        "given": once(len(warned), "", watched=False),
        "came true": once(len(warned) - false, "", "higher", watched=False),
        "median lead": once(median_lead_s(warned), "s", "higher", 0.1),
        "Brier score of those given": once(brier(warned), "", matters=0.02),
        "false ones per camera-day": once(false / camera_days, "", watched=False),
    }
