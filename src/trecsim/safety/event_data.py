"""What an event says, made of what a rule found out."""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from trecsim.geometry import Rig
from trecsim.safety.machine import Change
from trecsim.safety.rule import SEVERITIES, Rule, Severity
from trecsim.safety.rule_scene import Scene

EVIDENCE_S = 5.0
"""Events point to the recording from so long before to so long after [s]."""
TIME_DECIMALS = 3

Cameras = Callable[[Scene, int], Iterable[str]]
"""Tells which cameras have a person of a scene in view."""


def cameras_in_view(rig: Rig | None) -> Cameras:
    """Return what tells which cameras of a rig have a person in view; no rig, no camera."""

    def cameras(scene: Scene, row: int) -> Iterable[str]:
        xyz_m = scene.people.xyz_m[row]
        known = xyz_m[np.isfinite(xyz_m).all(axis=1)]
        for camera in rig.cameras if rig is not None and len(known) else ():
            x, y = camera.project(known).T
            width, height = camera.size_px
            if ((x >= 0.0) & (x < width) & (y >= 0.0) & (y < height)).any():
                yield camera.name

    return cameras


def person_entry(scene: Scene, row: int) -> dict[str, Any]:
    """Return a person as events list people; what is not known is None."""
    xy_m, cov_m2 = scene.floor.xy_m[row], scene.floor.cov_m2[row]
    return {
        "person": int(scene.people.id[row]),
        "floor_m": [_known(value, 3) for value in xy_m],
        "floor_cov_m2": [_known(cov_m2[i, j], 6) for i, j in ((0, 0), (0, 1), (1, 1))],
        "speed_mps": _known(scene.speed_mps(row), 2),
        "posture": str(scene.body.postures[row]) if scene.is_seen[row] else "unknown",
    }


def event_data(
    episode: str,
    rule: Rule,
    change: Change,
    t_s: float,
    people: list[dict[str, Any]],
    cameras: list[str],
    *,
    predicted: bool = False,
    lead_s: float | None = None,
) -> dict[str, Any]:
    """Return the `data` of an event, still without its place (`seq`) in the episode.

    Parameters
    ----------
    episode
        Identity of the episode.
    rule, change, t_s
        What happened, and the time of the frame set that decided [s].
    people
        Who has to do with it.
    cameras
        Which cameras have them in view.
    predicted
        Whether it is only expected.
    lead_s
        How long before its beginning a warning was given [s]; None without a warning.
    """
    found = change.finding
    optional = {
        "direction": found.direction,
        "count": found.count,
        "joints": list(found.joints) or None,
        "ended_by": None if change.ending in (None, "over") else change.ending,
    }
    place: dict[str, str] = {}
    if rule.place is not None:
        place[rule.place.kind] = rule.place.name
    until_s = t_s if change.end_s is None else change.end_s
    return {
        "event": episode,
        "phase": change.phase,
        "seq": 0,
        "severity": raised(rule.severity, change.level),
        "rule": {"id": rule.id, "kind": rule.kind.name, "config": rule.config},
        "t_start_s": round(change.start_s, TIME_DECIMALS),
        "t_detect_s": round(t_s, TIME_DECIMALS),
        "t_end_s": None if change.end_s is None else round(change.end_s, TIME_DECIMALS),
        "probability": round(found.probability, 4),
        "predicted": predicted,
        "lead_s": None if lead_s is None else _known(lead_s, TIME_DECIMALS),
        "people": people,
        **place,
        **{key: value for key, value in optional.items() if value is not None},
        "measures": _measures(rule, change, until_s),
        "threshold": {"p_on": rule.timing.p_on, **_numbers(rule.keys)},
        "evidence": {
            "t_from_s": round(change.since_s - EVIDENCE_S, TIME_DECIMALS),
            "t_to_s": round(until_s + EVIDENCE_S, TIME_DECIMALS),
            "cameras": cameras,
        },
    }


def raised(severity: Severity, level: int) -> Severity:
    """Return a severity that has risen.

    Examples
    --------
    >>> raised("warning", 1), raised("critical", 1)
    ('alarm', 'critical')
    """
    return SEVERITIES[min(SEVERITIES.index(severity) + level, len(SEVERITIES) - 1)]


def _measures(rule: Rule, change: Change, until_s: float) -> dict[str, float | None]:
    measures = {name: _known(value, 3) for name, value in change.finding.measures.items()}
    if rule.kind.hold_key is not None:
        measures[rule.kind.hold_key] = _known(until_s - change.since_s, 3)
    return measures


def _numbers(keys: Mapping[str, Any]) -> dict[str, float]:
    return {name: value for name, value in keys.items() if isinstance(value, int | float)}


def _known(value: float, decimals: int) -> float | None:
    return round(float(value), decimals) + 0.0 if math.isfinite(value) else None
