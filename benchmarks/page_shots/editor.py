"""Answers for the zone editor, for modes, and for why an alert fired; all of it made up."""

import math
from typing import Any

from page_shots.fixture import EDGES, MODES, RULES, START_S, ZONES
from trecsim.sites.rule_kinds import rule_kinds

VERSION = "0" * 64
NO_OTHERS: dict[str, Any] = {"exclusions": {}, "portals": {}}
DRAWN = [[-8.0, 1.6], [-3.2, 1.6], [-2.0, 2.4], [-2.4, 3.6], [-8.0, 3.6]]


def editor(drafted: bool) -> dict[str, Any]:
    """Return the bodies of the answers by path.

    Parameters
    ----------
    drafted
        Whether there is a draft beside the live version.
    """
    parts = {"zones": ZONES, "lines": {}, "edges": EDGES, **NO_OTHERS, "rules": RULES}
    return {
        "/api/site/parts": {"version": VERSION, **parts, "remarks": [], "has_file": True},
        "/api/site/kinds": {"kinds": rule_kinds()},
        "/api/site/draft": _draft() if drafted else None,
        "/api/site/draft/try": _trial(),
        "/api/mode": {
            "mode": "day", "scheduled": "day", "chosen": None, "bypassed": {}, "off": ["waited"],
            "modes": MODES, "longest_s": 28800.0,
        },
    }  # fmt: skip


def _draft() -> dict[str, Any]:
    bench = {"polygon_m": [[-7.0, 3.4], [-6.9, 3.4], [-6.9, 3.5], [-7.0, 3.5]]}
    waiting = {**ZONES["waiting-area"], "polygon_m": DRAWN}
    zones = {**ZONES, "waiting-area": waiting, "bench": bench}
    rules = [{**rule, "dwell_s": 900.0} if rule["id"] == "waited" else rule for rule in RULES]
    text = (
        "Too small: positions here are known to ± 3 cm, so the rule is at most 71 % certain, and "
        "needs 90 %. Make the zone larger."
    )
    return {
        "based_on": VERSION, "revision": 3, "by": "k.meier", "zones": zones, "lines": {},
        "edges": EDGES, **NO_OTHERS,
        "rules": [*rules, {"id": "bench", "kind": "zone.enter", "zone": "bench"}],
        "remarks": [{"at": ["zones", "bench"], "text": text}],
    }  # fmt: skip


def _trial() -> dict[str, Any]:
    counts = {"strip": (1, 1), "waited": (2, 9), "many": (0, 0), "edge": (0, 0), "fall": (0, 0)}
    episodes = [
        {
            "event": f"t{number}", "rule": rule, "kind": kind, "severity": severity,
            "t_start_s": START_S + 1.5 * number, "t_end_s": START_S + 1.5 * number + 2.0,
            "probability": 0.97, "people": [number], "place": place, "in": side,
        }
        for number, (rule, kind, severity, place, side) in enumerate([
            ("strip", "zone.restricted", "alarm", "edge-strip", "both"),
            *[("waited", "zone.dwell", "info", "waiting-area", "both")] * 2,
            *[("waited", "zone.dwell", "info", "waiting-area", "live")] * 7,
        ])
    ]  # fmt: skip
    return {
        "recording": "2026-11-30T13", "moments": 600, "people": 6, "from_s": START_S,
        "to_s": START_S + 24.0, "episodes": episodes, "left_out": 0,
        "rules": {name: {"draft": new, "live": old} for name, (new, old) in counts.items()},
    }  # fmt: skip


def curve() -> dict[str, Any]:
    """Return the probability over time of the alarm of the pictures."""
    times = [START_S - 5.0 + 0.1 * n for n in range(200)]
    begins_s = START_S + 5.0
    probability = [
        round(1.0 / (1.0 + math.exp(-6.0 * (t_s - begins_s))) * (t_s < START_S + 10.0), 4)
        for t_s in times
    ]
    return {
        "rule": "strip", "kind": "zone.restricted", "person": 4, "p_on": 0.9, "p_off": 0.5,
        "about": "Any joint that a camera supports is inside the prism of the zone.",
        "on_delay_s": 0.1, "off_delay_s": 0.5, "hold_s": 0.0, "keys": {}, "t_s": times,
        "probability": probability, "measures": {},
    }  # fmt: skip
