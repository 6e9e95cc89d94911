"""The JSON Schema of the messages of `/api/stream`, published at `/api/schema`."""

from functools import cache
from typing import Any

from trecsim.skeleton import COCO17

_JOINTS = len(COCO17.joints)


def _fixed(items: dict[str, Any], count: int) -> dict[str, Any]:
    return {"type": "array", "items": items, "minItems": count, "maxItems": count}


def _closed(about: str, properties: dict[str, Any], optional: tuple[str, ...] = ()) -> Any:
    required = [name for name in properties if name not in optional]
    return {
        "type": "object",
        "description": about,
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }


def _said(about: str, **more: Any) -> dict[str, Any]:
    return {"description": about, **more}


_NUMBER: dict[str, Any] = {"type": "number"}
_COUNT: dict[str, Any] = {"type": "integer", "minimum": 0}
_MAYBE: dict[str, Any] = {"type": ["number", "null"]}
_TEXT: dict[str, Any] = {"type": "string"}
_SENT_S = _said("Time of the server when the message was made, Unix time [s].", **_NUMBER)

_FORECAST = _closed(
    "Where the person will be, for one moment.",
    {
        "t_s": _said("The moment [s].", **_NUMBER),
        "xy_m": _said("Mean of the floor point [m].", **_fixed(_NUMBER, 2)),
        "cov_m2": _said("Its covariance xx, xy, yy [m^2].", **_fixed(_NUMBER, 3)),
    },
)
_PERSON = _closed(
    "One person.",
    {
        "person": _said("Identity, never reused in a recording.", type="integer"),
        "state": _said(
            "provisional: not yet sure to be a person; confirmed; coasting: no camera supports any "
            "joint, the track goes on without.",
            enum=["provisional", "confirmed", "coasting"],
        ),
        "seen_s": _said(
            "Seconds since a camera last supported a joint of the person; 0 while seen.",
            type="number", minimum=0,
        ),
        "posture": _said("Posture of the body.", enum=["upright", "low", "lying", "unknown"]),
        "xyz_m": _said(
            "Joints in the order of the skeleton, world frame [m], to the millimetre; null where "
            "missing.",
            **_fixed(_fixed(_MAYBE, 3), _JOINTS),
        ),
        "sigma_m": _said(
            "One standard deviation per joint [m]: root of the mean variance over the axes.",
            **_fixed(_MAYBE, _JOINTS),
        ),
        "support": _said(
            "Number of cameras that support the joint now; 0: carried along.",
            **_fixed(_COUNT, _JOINTS),
        ),
        "forecast": _said(
            "Five times a second, where there is one.", type="array", items=_FORECAST
        ),
    },
    optional=("forecast",),
)  # fmt: skip
_VEHICLE = _closed(
    "Where a vehicle is.",
    {
        "volume": _said("Its volume, which /api/site has, with its size.", **_TEXT),
        "id": _said("Which of the vehicles of this volume.", **_TEXT),
        "xy_m": _said("Its middle on the floor [m].", **_fixed(_NUMBER, 2)),
        "heading_deg": _said("Its heading [degrees]: 0 is +x, 90 is +y.", **_NUMBER),
    },
)
_SNAPSHOT = _closed(
    "Where everybody is. A viewer that is slow gets the newest one only.",
    {
        "type": {"const": "snapshot"},
        "sent_s": _SENT_S,
        "t_s": _said("The moment, on the clock of the cameras [s].", **_NUMBER),
        "people": {"type": "array", "items": {"$ref": "#/$defs/person"}},
        "volumes": _said(
            "Vehicles whose positions come from feeds, where there are any.",
            type="array", items=_VEHICLE,
        ),
    },
    optional=("volumes",),
)  # fmt: skip
_EVENT = _closed(
    "An event; none is left out. After a break give the id of the last one as last_event_id.",
    {
        "type": {"const": "event"},
        "sent_s": _SENT_S,
        "event": _said(
            "A CloudEvent 1.0, as in events.jsonl.",
            type="object",
            properties={"id": _TEXT, "type": _TEXT, "source": _TEXT, "data": {"type": "object"}},
            required=["id", "type"],
        ),
    },
)
_CAMERA = {
    "type": "object",
    "properties": {
        "state": {"enum": ["live", "stale", "down", "ended"]},
        "fps": _NUMBER,
        "age_s": _said("Age of the newest image [s]; null before the first.", **_MAYBE),
        "clock": _said("Whose clock dates the images.", enum=["sender", "arrival"]),
        "dropped": _said("Images that were left out.", **_COUNT),
        "dropped_by": _said("The same by reason.", type="object", additionalProperties=_COUNT),
        "fault": _said("What is wrong; null where nothing is.", type=["string", "null"]),
        "moved_deg": _said("How far it looks elsewhere than the rig says; null: not.", **_MAYBE),
        "moved_since_s": _said("Since when [s]; null where it does not.", **_MAYBE),
        "repaired_deg": _said("How far a repair has turned its pose; null: not.", **_MAYBE),
        "clock_late_ms": _said(
            "How late its clock is, as the tracker estimates it [ms].", **_MAYBE
        ),
    },
    "required": ["state", "fps", "age_s", "clock", "dropped"],
}
_COUNTS = _closed(
    "People in zones and over lines.",
    {
        "since_s": _said("Since when crossings are counted [s].", **_MAYBE),
        "zones": {
            "type": "object",
            "additionalProperties": _closed(
                "How full a zone is.",
                {
                    "inside": _COUNT,
                    "density_pm2": _said("Voronoi density [people/m^2].", **_MAYBE),
                    "level": _said("Level of service, A to F.", type=["string", "null"]),
                },
            ),
        },
        "lines": {
            "type": "object",
            "additionalProperties": _closed("Crossings.", {"in": _COUNT, "out": _COUNT}),
        },
    },
)
_HEALTH = {
    "type": "object",
    "description": "How well the site works: twice a second. What /api/health says.",
    "properties": {
        "type": {"const": "health"},
        "sent_s": _SENT_S,
        "status": {"enum": ["ok", "fault"]},
        "faults": _said("What is wrong, in words.", type="array", items=_TEXT),
        "cameras": {"type": "object", "additionalProperties": _CAMERA},
        "fusion": {"type": "object", "required": ["state"]},
        "store": {"type": "object", "required": ["state"]},
        "counts": _COUNTS,
    },
    "required": ["type", "sent_s", "status", "faults", "cameras", "fusion", "store"],
}


@cache
def stream_schema() -> dict[str, Any]:
    """Return the schema of one message."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A message of the stream of trecsim",
        "description": f"Joints: {', '.join(COCO17.joints)}.",
        "oneOf": [{"$ref": f"#/$defs/{name}"} for name in ("snapshot", "event", "health")],
        "$defs": {"snapshot": _SNAPSHOT, "event": _EVENT, "health": _HEALTH, "person": _PERSON},
    }
