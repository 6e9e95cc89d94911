"""The events of a fault of the site itself: that it begins, gets worse, and ends."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

from trecsim.cloud_events import derived_id, event_of
from trecsim.service.site_parts import KINDS, LIMITS, PartState

TYPES = tuple(f"trecsim.{kind}.v1" for kind in KINDS)
"""Types of these events."""


def begun(
    site: str, part: PartState, now_s: float, people: Sequence[Mapping[str, Any]] = ()
) -> dict[str, Any]:
    """Return the event that a fault begins, without its place in the episode.

    The episode belongs to the rule and the camera or output. It points to no tracks: these are not
    kept longer because a camera failed.

    Parameters
    ----------
    site
        Name of the site.
    part
        What failed.
    now_s
        When that was decided, Unix time [s].
    people
        Who was at the site then.
    """
    start_s = round(part.since_s, 3)
    place = part.place
    data = {
        "event": derived_id(site, part.kind, part.name, start_s),
        "phase": "new",
        "severity": KINDS[part.kind],
        "rule": _rule(part),
        "t_start_s": start_s,
        "t_detect_s": round(now_s, 3),
        "t_end_s": None,
        "probability": 1.0,
        "predicted": False,
        "lead_s": None,
        "people": list(people),
        **place,
        **_found(part),
        "evidence": {
            "t_from_s": None,
            "t_to_s": None,
            "cameras": [place["camera"]] if "camera" in place else [],
        },
    }
    return event_of(site, data, now_s)


def worse(site: str, before: Mapping[str, Any], part: PartState, now_s: float) -> dict[str, Any]:
    """Return the event that a fault got worse; see `begun`.

    Parameters
    ----------
    site
        Name of the site.
    before
        Data of the last event of the episode.
    part
        What failed, as it is now.
    now_s
        When that was decided, Unix time [s].
    """
    data = {**before, "phase": "update", "t_detect_s": round(now_s, 3), **_found(part)}
    return event_of(site, data, now_s)


def ended(site: str, before: Mapping[str, Any], end_s: float, now_s: float) -> dict[str, Any]:
    """Return the event that a fault ended; see `begun`.

    Parameters
    ----------
    site
        Name of the site.
    before
        Data of the last event of the episode.
    end_s
        Since when the part works again, Unix time [s].
    now_s
        When that was decided, Unix time [s].
    """
    end_s = max(round(end_s, 3), before["t_start_s"])
    data = {**before, "phase": "end", "t_detect_s": round(now_s, 3), "t_end_s": end_s}
    return event_of(site, data, now_s)


def _found(part: PartState) -> dict[str, Any]:
    measures = {
        name: None if value is None else round(value, 3) for name, value in part.measures.items()
    }
    return {"state": part.state, "fault": part.said, "measures": measures}


def _rule(part: PartState) -> dict[str, str]:
    """Return the rule of a fault, which no site file has to name."""
    rule = {"id": part.kind.replace(".", "-"), "kind": part.kind}
    facts = {**rule, "severity": KINDS[part.kind], **LIMITS[part.kind], "camera": part.name}
    text = json.dumps(facts, sort_keys=True)
    return {**rule, "config": hashlib.sha256(text.encode()).hexdigest()}
