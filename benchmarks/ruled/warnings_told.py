"""What came of early warnings: which came true, how long before, and how sure they were."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np


class Warned(NamedTuple):
    """One early warning.

    Attributes
    ----------
    probability
        That it told.
    came_true
        Whether the condition began.
    lead_s
        How long before; NaN where it did not [s].
    """

    probability: float
    came_true: bool
    lead_s: float


def warnings_of(events: Iterable[Mapping[str, Any]]) -> list[Warned]:
    """Return the warnings among events; those that are open at the end are left out.

    An early warning at an edge comes true when the person is beyond the edge, not when near it:
    only the events of people beyond it have a lead.
    """
    given: dict[str, float] = {}
    done: list[Warned] = []
    for event in events:
        data = event["data"]
        identity = data["event"]
        came = not data["predicted"] and data["lead_s"] is not None
        if data["phase"] == "new" and data["predicted"]:
            given[identity] = float(data["probability"])
        elif identity in given and (came or data["phase"] == "end"):
            lead_s = float(data["lead_s"]) if came else float("nan")
            done.append(Warned(given.pop(identity), came, lead_s))
    return done


def brier(warned: Iterable[Warned]) -> float:
    """Return the mean squared difference of probability and outcome; NaN of none."""
    errors = [(one.probability - one.came_true) ** 2 for one in warned]
    return float(np.mean(errors)) if errors else float("nan")


def median_lead_s(warned: Iterable[Warned]) -> float:
    """Return the median time between warning and beginning [s]; NaN of none."""
    leads_s = [one.lead_s for one in warned if one.came_true]
    return float(np.median(leads_s)) if leads_s else float("nan")
