"""Events with the topics and payloads that ONVIF's analytics use over MQTT: a pure adapter.

Notes
-----
ONVIF's core specification publishes an event as JSON on ``PREFIX/onvif-ej/TOPIC/&SOURCE``: the
topic without its namespace, the values of the source after an ampersand, and a body ``{"UtcTime",
"Source": {}, "Data": {}}``. Only the names follow ONVIF; this is no conformant device.
"""

import json
import time
from typing import Any, NamedTuple

from trecsim.cloud_events import UNIX_FROM_S, rfc3339
from trecsim.outputs.base import Event

TOPICS = {
    "zone.enter": "RuleEngine/FieldDetector/ObjectsInside",
    "zone.exit": "RuleEngine/FieldDetector/ObjectsInside",
    "zone.restricted": "RuleEngine/FieldDetector/ObjectsInside",
    "zone.dwell": "RuleEngine/LoiteringDetector/ObjectIsLoitering",
    "line.cross": "RuleEngine/LineDetector/Crossed",
    "occupancy.limit": "RuleEngine/CountAggregation/OccupancyCounter",
}
"""ONVIF's topics of kinds that it knows; all others are ``RuleEngine/Trecsim/KIND``."""


class OnvifMessage(NamedTuple):
    """A message as ONVIF sends it over MQTT.

    Attributes
    ----------
    topic
        Without the prefix.
    body
        JSON text.
    retained
        Whether the broker keeps it: the state of something, not a momentary event.
    """

    topic: str
    body: str
    retained: bool


def onvif_message(event: Event) -> OnvifMessage:
    """Return an event as ONVIF would send it.

    Examples
    --------
    >>> made = onvif_message({
    ...     "data": {
    ...         "rule": {"id": "gate", "kind": "line.cross"}, "t_detect_s": 1e9, "t_start_s": 1e9,
    ...         "t_end_s": 1e9, "phase": "new", "people": [{"person": 7}],
    ...     }
    ... })
    >>> made.topic, made.retained
    ('onvif-ej/RuleEngine/LineDetector/Crossed/&gate', False)
    """
    data = event["data"]
    rule, kind = data["rule"]["id"], data["rule"]["kind"]
    topic = TOPICS.get(kind, f"RuleEngine/Trecsim/{_camel(kind)}")
    momentary = data["phase"] == "new" and data.get("t_end_s") is not None
    body = {
        "UtcTime": rfc3339(_unix_s(data["t_detect_s"])),
        "Source": {"Rule": rule},
        "Data": _facts(kind, data, momentary),
    }
    text = json.dumps(body, separators=(",", ":"))
    return OnvifMessage(f"onvif-ej/{topic}/&{rule}", text, not momentary)


def _facts(kind: str, data: dict[str, Any], momentary: bool) -> dict[str, Any]:
    """Return what ONVIF tells in `Data`."""
    facts: dict[str, Any] = {
        "ObjectId": ",".join(str(one["person"]) for one in data.get("people", ()))
    }
    active = data.get("t_end_s") is None
    if kind == "zone.exit":
        facts["IsInside"] = False
    elif kind in ("zone.enter", "zone.restricted"):
        facts["IsInside"] = active
    elif kind == "zone.dwell":
        facts["Since"] = rfc3339(_unix_s(data["t_start_s"]))
    elif kind == "occupancy.limit":
        facts["Count"] = data.get("count")
    if "direction" in data:
        facts["Direction"] = data["direction"]
    if not momentary:
        facts["State"] = active
    return facts


def _unix_s(t_s: float) -> float:
    return t_s if t_s >= UNIX_FROM_S else time.time()


def _camel(kind: str) -> str:
    """Return a kind as one word.

    Examples
    --------
    >>> _camel("flow.wrong_way")
    'FlowWrongWay'
    """
    return "".join(part.capitalize() for part in kind.replace("_", ".").split("."))
