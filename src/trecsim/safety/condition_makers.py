"""Conditions made from rules, by the place and the keys of each: one function for each kind."""

import math
from typing import Literal

import numpy as np

from trecsim.safety.conditions.base import Condition
from trecsim.safety.conditions.body_poses import Climbing, ReachingIn
from trecsim.safety.conditions.crossings import LineCrossed, ZoneLeft
from trecsim.safety.conditions.crowds import Bottleneck, CriticalDensity, Pressure
from trecsim.safety.conditions.density import DensityLevel
from trecsim.safety.conditions.distress import Distress
from trecsim.safety.conditions.edges import AtEdge
from trecsim.safety.conditions.falls import Down, Fallen
from trecsim.safety.conditions.gates import GatePassed
from trecsim.safety.conditions.movement import Running, WrongWay
from trecsim.safety.conditions.panic import Panic
from trecsim.safety.conditions.split_groups import Separated
from trecsim.safety.conditions.unloading import Unloading
from trecsim.safety.conditions.vehicles import NearVolume, OnVolume
from trecsim.safety.conditions.zones import InZone, JointInZone, Occupancy, OutOfZone
from trecsim.safety.directed_lines import Edge, Line
from trecsim.safety.polygons import Polygon, Prism
from trecsim.safety.rule import Rule
from trecsim.safety.volumes import FedVolume, Moving, Volume


def _prism(rule: Rule) -> Prism:
    assert rule.place is not None
    assert isinstance(rule.place.shape, Prism)
    return rule.place.shape


def _polygon(rule: Rule) -> Polygon:
    return _prism(rule).polygon


def _polygon_or_none(rule: Rule) -> Polygon | None:
    return None if rule.place is None else _polygon(rule)


def in_zone(rule: Rule) -> Condition:
    """Return the condition that a floor point is in the zone."""
    return InZone(_polygon(rule))


def joint_in_zone(rule: Rule) -> Condition:
    """Return the condition that a joint is in the prism of the zone."""
    return JointInZone(_prism(rule))


def left(rule: Rule) -> Condition:
    """Return the condition that a person has left the zone."""
    return ZoneLeft(_polygon(rule), rule.timing.on_delay_s, rule.timing.p_on)


def crossed(rule: Rule) -> Condition:
    """Return the condition that a person has crossed the line."""
    assert rule.place is not None
    assert isinstance(rule.place.shape, Line)
    direction: Literal["in", "out", "both"] = rule.keys["direction"]
    return LineCrossed(rule.place.shape, direction, rule.timing.on_delay_s, rule.timing.p_on)


def occupied(rule: Rule) -> Condition:
    """Return the condition that the zone holds at least `limit` people."""
    return Occupancy(_polygon(rule), rule.keys["limit"])


def dense(rule: Rule) -> Condition:
    """Return the condition that the zone is at a level of service or above."""
    return DensityLevel(_polygon(rule), rule.keys["level"])


def running(rule: Rule) -> Condition:
    """Return the condition that a person runs."""
    return Running(rule.keys["speed_mps"], _polygon_or_none(rule))


def wrong_way(rule: Rule) -> Condition:
    """Return the condition that a person moves against the allowed heading."""
    heading_rad = math.radians(rule.keys["heading_deg"])
    return WrongWay(_polygon(rule), (float(np.cos(heading_rad)), float(np.sin(heading_rad))))


def at_edge(rule: Rule) -> Condition:
    """Return the condition that a joint is near the edge or beyond it."""
    assert rule.place is not None
    assert isinstance(rule.place.shape, Edge)
    return AtEdge(rule.place.shape, rule.keys["distance_m"], rule.keys["depth_m"])


def fallen(rule: Rule) -> Condition:
    """Return the condition that a person lies after a fall."""
    return Fallen(_polygon_or_none(rule), rule.exclusions)


def down(rule: Rule) -> Condition:
    """Return the condition that a person is on the floor without a fall that was seen."""
    return Down(_polygon_or_none(rule), rule.exclusions)


def out_of_zone(rule: Rule) -> Condition:
    """Return the condition that a person is outside the zone after having been inside."""
    return OutOfZone(_polygon(rule))


def critical(rule: Rule) -> Condition:
    """Return the condition that the density in the zone is critical."""
    return CriticalDensity(_polygon(rule), rule.keys["density_pm2"], rule.keys["grave_pm2"])


def pressed(rule: Rule) -> Condition:
    """Return the condition that the crowd pressure in the zone is too high."""
    return Pressure(_polygon(rule), rule.keys["pressure_ps2"], rule.keys["grave_ps2"])


def clogged(rule: Rule) -> Condition:
    """Return the condition that fewer people than usual leave the zone as it fills."""
    return Bottleneck(_polygon(rule), rule.keys["share"], rule.keys["density_pm2"])


def panicking(rule: Rule) -> Condition:
    """Return the condition that people begin to run together."""
    keys = rule.keys
    return Panic(keys["people"], keys["share"], keys["speed_mps"], _polygon_or_none(rule))


def climbing(rule: Rule) -> Condition:
    """Return the condition that a person climbs over the zone."""
    return Climbing(_prism(rule))


def reaching(rule: Rule) -> Condition:
    """Return the condition that a person reaches into the zone."""
    return ReachingIn(_prism(rule))


def distressed(rule: Rule) -> Condition:
    """Return the condition that a person holds up both hands, or waves."""
    return Distress(_polygon_or_none(rule))


def separated(rule: Rule) -> Condition:
    """Return the condition that a person is far from the rest of their group."""
    return Separated(rule.keys["distance_m"], rule.keys["together_s"])


def _volume(rule: Rule) -> Moving:
    assert rule.place is not None
    assert isinstance(rule.place.shape, Volume | FedVolume)
    return rule.place.shape


def near_volume(rule: Rule) -> Condition:
    """Return the condition that a joint is near the moving volume."""
    return NearVolume(_volume(rule), rule.keys["distance_m"])


def on_volume(rule: Rule) -> Condition:
    """Return the condition that a joint is in the moving volume."""
    return OnVolume(_volume(rule), rule.keys["after_s"])


def unloading(rule: Rule) -> Condition:
    """Return the condition that a person is still on a chair, or in the way of the next one."""
    line, strip = (rule.others[key].shape for key in ("line", "strip"))
    assert isinstance(line, Line)
    assert isinstance(strip, Prism)
    return Unloading(_volume(rule), line, strip.polygon, rule.keys["next_s"])


def tailgated(rule: Rule) -> Condition:
    """Return the condition that a person passes the gate on a used-up grant."""
    return _gate(rule, "tailgate", "free")


def unauthorised(rule: Rule) -> Condition:
    """Return the condition that a person passes the gate without a grant."""
    return _gate(rule, "unauthorised", rule.keys["way_back"])


def _gate(
    rule: Rule, tells: Literal["tailgate", "unauthorised"], way_back: Literal["closed", "free"]
) -> Condition:
    assert rule.place is not None
    assert isinstance(rule.place.shape, Line)
    keys, timing = rule.keys, rule.timing
    return GatePassed(
        rule.place.shape, rule.place.name, keys["feed"], keys["window_s"], keys["direction"],
        tells, way_back, timing.on_delay_s, timing.p_on,
    )  # fmt: skip
