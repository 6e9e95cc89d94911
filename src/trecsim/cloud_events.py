"""Events as CloudEvents 1.0: the envelope around what an event says, and derived identities.

An identity follows from the facts of an event, so the same happening always has the same one.
"""

import hashlib
import json
import time
from collections.abc import Mapping
from typing import Any

UNIX_FROM_S = 1e9
"""Times from here on are Unix times [s]."""


def event_of(site: str, data: Mapping[str, Any], now_s: float) -> dict[str, Any]:
    """Return an event, without its place in the episode, around its data.

    Parameters
    ----------
    site
        Name of the site.
    data
        What the event says; `rule` names its `id` and `kind`.
    now_s
        When it was decided [s]; the event is dated where that is a Unix time.
    """
    rule = data["rule"]
    dated = {"time": rfc3339(now_s)} if now_s >= UNIX_FROM_S else {}
    return {
        "specversion": "1.0",
        "type": f"trecsim.{rule['kind']}.v1",
        "source": f"site/{site}",
        "subject": f"rule/{rule['id']}",
        **dated,
        "data": dict(data),
    }


def numbered(event: Mapping[str, Any], sequence: int) -> dict[str, Any]:
    """Return an event with its place in its episode, and the `id` that follows from it.

    Parameters
    ----------
    event
        An event with `source`, and with `event` and `phase` in its data.
    sequence
        Its `seq`.

    Examples
    --------
    >>> event = {"source": "site/hall", "data": {"event": "e", "phase": "end"}}
    >>> numbered(event, 2)["data"]
    {'event': 'e', 'phase': 'end', 'seq': 2}
    >>> numbered(event, 2)["id"] == numbered(event, 2)["id"] != numbered(event, 3)["id"]
    True
    """
    data = event["data"]
    identity = derived_id(event.get("source"), data["event"], sequence, data["phase"])
    return {**event, "id": identity, "data": {**data, "seq": sequence}}


def event_text(event: Mapping[str, Any]) -> str:
    """Return an event as JSON, the same wherever it is kept.

    Raises
    ------
    TypeError, ValueError
        When it holds what JSON cannot, or numbers that are not finite.
    """
    return json.dumps(event, ensure_ascii=False, separators=(",", ":"), allow_nan=False)


def derived_id(*facts: object) -> str:
    """Return an id that the same facts always give."""
    text = json.dumps(facts, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def rfc3339(t_s: float) -> str:
    """Return a Unix time [s] as events tell it.

    Examples
    --------
    >>> rfc3339(1e9)
    '2001-09-09T01:46:40.000Z'
    """
    whole, thousandths = divmod(round(t_s * 1000), 1000)
    return f"{time.strftime('%Y-%m-%dT%H:%M:%S', time.gmtime(whole))}.{thousandths:03d}Z"
