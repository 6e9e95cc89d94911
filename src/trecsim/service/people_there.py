"""Who was at the site, as events list people."""

from typing import Any

from trecsim.safety.event_data import person_entry
from trecsim.safety.rule_scene import Memory
from trecsim.values import Snapshot


def people_of(snapshot: Snapshot) -> list[dict[str, Any]]:
    """Return the confirmed people of a snapshot as events list them; see `person_entry`."""
    scene = Memory().take(snapshot)
    return [person_entry(scene, row) for row in range(len(scene.people.id))]
