"""Events as the rules make them, without people and cameras."""

from typing import Any

from trecsim.cloud_events import event_of, numbered


def made_event(episode: str = "e", phase: str = "new", seq: int = 0, **data: Any) -> dict[str, Any]:
    """Return an event of rule "strip" of the site "hall"."""
    facts = {
        "event": episode,
        "phase": phase,
        "severity": "warning",
        "rule": {"id": "strip", "kind": "zone.enter", "config": "0"},
        "t_start_s": 1.7e9,
        "t_detect_s": 1.7e9 + 1.0,
        "t_end_s": 1.7e9 + 2.0 if phase == "end" else None,
        "probability": 0.97,
        "predicted": False,
        "lead_s": None,
        "people": [{"person": 3, "floor_m": [1.0, 2.0]}],
        "zone": "exit-strip",
        "evidence": {"t_from_s": None, "t_to_s": None, "cameras": []},
        **data,
    }
    return numbered(event_of("hall", facts, 1.7e9 + 1.0), seq)
