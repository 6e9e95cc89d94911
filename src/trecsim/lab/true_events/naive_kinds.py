"""What each kind of rule means, read naively: for each a function from people to episodes.

Conditions on one person take the person, those on a place everybody. Distances and times are those
of the documentation of the rules, written down a second time.
"""

from collections.abc import Mapping

from trecsim.lab.true_events.naive_bodies import climb, down, edge, fall, reach, restricted
from trecsim.lab.true_events.naive_crowds import (
    bottleneck,
    critical,
    density_level,
    occupancy,
    pressure,
)
from trecsim.lab.true_events.naive_floor_points import confined, cross, dwell, enter, gate, leave
from trecsim.lab.true_events.naive_groups import panic, split
from trecsim.lab.true_events.naive_hands import distress
from trecsim.lab.true_events.naive_movement import goes_wrong_way, runs
from trecsim.lab.true_events.naive_volumes import on_volume, unload, vehicle
from trecsim.lab.true_events.true_places import Read, each

NAIVE_KINDS: Mapping[str, Read] = {
    "zone.enter": each(enter),
    "zone.exit": leave,
    "zone.dwell": each(dwell),
    "zone.restricted": each(restricted),
    "zone.confined": each(confined),
    "line.cross": cross,
    "occupancy.limit": occupancy,
    "density.level": density_level,
    "speed.running": each(runs),
    "flow.wrong_way": each(goes_wrong_way),
    "edge.platform": edge,
    "body.fall": each(fall),
    "body.down": each(down),
    "body.reach": each(reach),
    "ttc.vehicle": each(vehicle),
    "volume.enter": each(on_volume),
    "lift.unload": each(unload),
    "access.tailgate": gate,
    "access.unauthorised": gate,
    "body.climb": each(climb),
    "body.distress": each(distress),
    "crowd.panic": panic,
    "crowd.pressure": pressure,
    "density.critical": critical,
    "flow.bottleneck": bottleneck,
    "group.split": split,
}
"""All kinds of which the truth is known, by name."""
