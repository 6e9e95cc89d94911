"""The messages of `/api/stream`, as text: encoded once, sent to all viewers."""

import math
from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np

from trecsim.page.link import SnapshotPart
from trecsim.safety.vehicle import PlacedVehicle
from trecsim.skeleton import COCO17

DECIMALS = 3  # of metres and seconds; snapshots come rounded, see trecsim.store.precision
SIGMA_DECIMALS = 4
HEADING_DECIMALS = 1  # of degrees
_JOINTS = len(COCO17.joints)

_encode = msgspec.json.Encoder().encode


def snapshot_body(
    part: SnapshotPart, forecasts: Mapping[int, list[dict[str, Any]]] | None = None
) -> dict[str, Any]:
    """Return a snapshot as the stream and recordings give it, without the time of sending.

    `forecasts` are by person, as `forecast_bodies` gives them; people without have no such key.
    Without vehicles whose positions come from feeds there is no `volumes`.

    Coordinates have three decimals, uncertainties four; what is missing (NaN) is null in JSON.
    """
    people = len(part.state)
    xyz_m = np.frombuffer(part.xyz_m).reshape(people, _JOINTS, 3).round(DECIMALS)
    sigma_m = np.frombuffer(part.sigma_m).reshape(people, _JOINTS).round(SIGMA_DECIMALS)
    support = np.frombuffer(part.support, np.int64).reshape(people, _JOINTS)
    columns = zip(
        np.frombuffer(part.id, np.int64).tolist(), part.state, part.seen_s, part.posture,
        xyz_m.tolist(), sigma_m.tolist(), support.tolist(), strict=True,
    )  # fmt: skip
    return {
        "t_s": part.t_s,
        "people": [
            {
                "person": person, "state": state, "seen_s": round(seen_s, DECIMALS),
                "posture": posture, "xyz_m": xyz, "sigma_m": sigma, "support": joint_support,
                **({"forecast": forecasts[person]} if forecasts and person in forecasts else {}),
            }
            for person, state, seen_s, posture, xyz, sigma, joint_support in columns
        ],
        **({"volumes": [_vehicle(one) for one in part.vehicles]} if part.vehicles else {}),
    }  # fmt: skip


def _vehicle(one: PlacedVehicle) -> dict[str, Any]:
    """Return a vehicle with the keys of the messages that told where it is."""
    return {
        "volume": one.volume,
        "id": one.vehicle,
        "xy_m": [round(axis_m, DECIMALS) for axis_m in one.xy_m],
        "heading_deg": round(math.degrees(one.heading_rad), HEADING_DECIMALS),
    }


def message(kind: str, sent_s: float, body: Mapping[str, Any]) -> str:
    """Return a message of the stream.

    Parameters
    ----------
    kind
        "snapshot", "health" or "event".
    sent_s
        When it is sent, Unix time [s].
    body
        Further keys.
    """
    return _encode({"type": kind, "sent_s": round(sent_s, DECIMALS), **body}).decode()


def json_bytes(body: Any) -> bytes:
    """Return JSON, NaN as null."""
    return _encode(body)
