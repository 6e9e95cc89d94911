"""The table of all kinds of rules: their keys, their defaults, and where the numbers come from."""

import math
from typing import Literal

import numpy as np

from trecsim.safety.conditions.base import Condition
from trecsim.safety.conditions.body_poses import Climbing, Distress, ReachingIn
from trecsim.safety.conditions.crossings import LineCrossed, ZoneLeft
from trecsim.safety.conditions.crowds import Bottleneck, CriticalDensity, Panic, Pressure
from trecsim.safety.conditions.density import DensityLevel, Level
from trecsim.safety.conditions.edges import AtEdge
from trecsim.safety.conditions.falls import Down, Fallen
from trecsim.safety.conditions.gates import GatePassed
from trecsim.safety.conditions.movement import Running, WrongWay
from trecsim.safety.conditions.split_groups import Separated
from trecsim.safety.conditions.unloading import Unloading
from trecsim.safety.conditions.vehicles import NearVolume, OnVolume
from trecsim.safety.conditions.zones import InZone, JointInZone, Occupancy, OutOfZone
from trecsim.safety.directed_lines import Edge, Line
from trecsim.safety.own_kinds import own_kinds
from trecsim.safety.polygons import Polygon, Prism
from trecsim.safety.rule import Key, Kind, Rule
from trecsim.safety.signals import LONGEST_S
from trecsim.safety.volumes import FedVolume, Moving, Volume


def _prism(rule: Rule) -> Prism:
    assert rule.place is not None
    assert isinstance(rule.place.shape, Prism)
    return rule.place.shape


def _polygon(rule: Rule) -> Polygon:
    return _prism(rule).polygon


def _polygon_or_none(rule: Rule) -> Polygon | None:
    return None if rule.place is None else _polygon(rule)


def _in_zone(rule: Rule) -> Condition:
    return InZone(_polygon(rule))


def _joint_in_zone(rule: Rule) -> Condition:
    return JointInZone(_prism(rule))


def _left(rule: Rule) -> Condition:
    return ZoneLeft(_polygon(rule), rule.timing.on_delay_s, rule.timing.p_on)


def _crossed(rule: Rule) -> Condition:
    assert rule.place is not None
    assert isinstance(rule.place.shape, Line)
    direction: Literal["in", "out", "both"] = rule.keys["direction"]
    return LineCrossed(rule.place.shape, direction, rule.timing.on_delay_s, rule.timing.p_on)


def _occupied(rule: Rule) -> Condition:
    return Occupancy(_polygon(rule), rule.keys["limit"])


def _dense(rule: Rule) -> Condition:
    return DensityLevel(_polygon(rule), rule.keys["level"])


def _running(rule: Rule) -> Condition:
    return Running(rule.keys["speed_mps"], _polygon_or_none(rule))


def _wrong_way(rule: Rule) -> Condition:
    heading_rad = math.radians(rule.keys["heading_deg"])
    return WrongWay(_polygon(rule), (float(np.cos(heading_rad)), float(np.sin(heading_rad))))


def _at_edge(rule: Rule) -> Condition:
    assert rule.place is not None
    assert isinstance(rule.place.shape, Edge)
    return AtEdge(rule.place.shape, rule.keys["distance_m"], rule.keys["depth_m"])


def _fallen(rule: Rule) -> Condition:
    return Fallen(_polygon_or_none(rule), rule.exclusions)


def _down(rule: Rule) -> Condition:
    return Down(_polygon_or_none(rule), rule.exclusions)


def _out_of_zone(rule: Rule) -> Condition:
    return OutOfZone(_polygon(rule))


def _critical(rule: Rule) -> Condition:
    return CriticalDensity(_polygon(rule), rule.keys["density_pm2"], rule.keys["grave_pm2"])


def _pressed(rule: Rule) -> Condition:
    return Pressure(_polygon(rule), rule.keys["pressure_ps2"], rule.keys["grave_ps2"])


def _clogged(rule: Rule) -> Condition:
    return Bottleneck(_polygon(rule), rule.keys["share"])


def _panicking(rule: Rule) -> Condition:
    keys = rule.keys
    return Panic(keys["people"], keys["share"], keys["speed_mps"], _polygon_or_none(rule))


def _climbing(rule: Rule) -> Condition:
    return Climbing(_prism(rule))


def _reaching(rule: Rule) -> Condition:
    return ReachingIn(_prism(rule))


def _distressed(rule: Rule) -> Condition:
    return Distress(_polygon_or_none(rule))


def _separated(rule: Rule) -> Condition:
    return Separated(rule.keys["distance_m"], rule.keys["together_s"])


def _volume(rule: Rule) -> Moving:
    assert rule.place is not None
    assert isinstance(rule.place.shape, Volume | FedVolume)
    return rule.place.shape


def _near_volume(rule: Rule) -> Condition:
    return NearVolume(_volume(rule), rule.keys["distance_m"])


def _on_volume(rule: Rule) -> Condition:
    return OnVolume(_volume(rule), rule.keys["after_s"])


def _unloading(rule: Rule) -> Condition:
    line, strip = (rule.others[key].shape for key in ("line", "strip"))
    assert isinstance(line, Line)
    assert isinstance(strip, Prism)
    return Unloading(_volume(rule), line, strip.polygon, rule.keys["next_s"])


def _tailgated(rule: Rule) -> Condition:
    return _gate(rule, "tailgate", "free")


def _unauthorised(rule: Rule) -> Condition:
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


_SECONDS = {"gt": 0.0, "le": 86400.0}

_GATE = (
    Key("feed", str, "The feed that says who may pass.", names="feed"),
    Key("window_s", float, "How long a grant is valid if the door is not shut before [s].", 5.0,
        {"gt": 0.0, "le": LONGEST_S}),
    Key("direction", Literal["in", "out"],
        'The authorised direction; "in" is from the right of the line to its left.', "in"),
)  # fmt: skip

_DENSITY = {"gt": 0.0, "le": 20.0}

_ALL = (
    Kind(
        "zone.enter",
        "The floor point is inside the zone.",
        "delay: NVIDIA behaviour analytics, 0.1 to 0.5 s",
        _in_zone, place="zone", on_delay_s=0.2, can_warn=True,
    ),
    Kind(
        "zone.exit",
        "The floor point has left the zone: it is 0.15 m outside.",
        "delay as of zone.enter; distance: ours",
        _left, place="zone", on_delay_s=0.2, at_once=True,
    ),
    Kind(
        "zone.dwell",
        "The floor point has been inside the zone for `dwell_s`; gaps up to 2 s are bridged.",
        "60 s as i-LIDS for parked vehicles; three times as long raises the severity: ours",
        _in_zone, place="zone", off_delay_s=2.0, gap_s=2.0, escalate_s=3.0, hold_key="dwell_s",
        keys=(Key("dwell_s", float, "How long somebody may be in the zone [s].", 60.0, _SECONDS),),
    ),
    Kind(
        "zone.restricted",
        "Any joint that a camera supports is inside the prism of the zone.",
        "delay: restricted area of NVIDIA behaviour analytics, 0.1 s",
        _joint_in_zone, place="zone", on_delay_s=0.1, early_s=2.0, can_warn=True,
    ),
    Kind(
        "line.cross",
        "The floor point has crossed the line: it is 0.15 m on the other side.",
        "distance: ours",
        _crossed, place="line", at_once=True,
        keys=(
            Key(
                "direction", Literal["in", "out", "both"],
                'Which crossings count; "in" is from the right of the line to its left.', "both",
            ),
        ),
    ),
    Kind(
        "occupancy.limit",
        "At least `limit` people are inside the zone.",
        "delay: field-of-view count of NVIDIA behaviour analytics, 2 s",
        _occupied, place="zone", on_delay_s=2.0, is_about_place=True,
        keys=(Key("limit", int, "So many people.", limits={"ge": 1, "le": 10_000}),),
    ),
    Kind(
        "density.level",
        "The Voronoi density in the zone is at a level of service of walkways or above; level F "
        "with people who move counts at once, with a higher severity.",
        "levels: Fruin; delay and least area of 4 m2: ours",
        _dense, place="zone", on_delay_s=10.0, is_about_place=True,
        keys=(Key("level", Level, "From which level on.", "E"),),
    ),
    Kind(
        "speed.running",
        "The median speed of the hips over the last second is above `speed_mps`.",
        "2.2 m/s: pedestrians walk at 1.5 m/s (median), nine in ten below 1.8 m/s in ETH/UCY",
        _running, place="zone", place_is_optional=True, on_delay_s=0.8,
        keys=(Key("speed_mps", float, "The speed [m/s].", 2.2, {"gt": 0.0, "le": 20.0}),),
    ),
    Kind(
        "flow.wrong_way",
        "The hips move against `heading_deg` in the zone: faster than 0.5 m/s, over 1.5 m.",
        "ours",
        _wrong_way, place="zone", on_delay_s=1.0,
        keys=(
            Key(
                "heading_deg", float,
                "The allowed heading [degrees]: 0 is +x, 90 is +y.",
                limits={"ge": -360.0, "le": 360.0},
            ),
        ),
    ),
    Kind(
        "edge.platform",
        "Any joint that a camera supports is within `distance_m` of the edge; beyond the edge "
        "it counts at once, with a higher severity.",
        "distance and delay: ours",
        _at_edge, place="edge", on_delay_s=2.0, early_s=2.0, can_warn=True,
        keys=(
            Key("distance_m", float, "So near is near [m].", 0.5, {"gt": 0.0, "le": 100.0}),
            Key(
                "depth_m", float,
                "How wide the drop is: joints farther beyond the edge do not count [m].",
                1000.0, {"gt": 0.0, "le": 1000.0},
            ),
        ),
    ),
    Kind(
        "body.fall",
        "Somebody lies who came down with the movement of a fall.",
        "posture and height rate: Yao 2017, Bourke 2008; heights and speeds: ours",
        _fallen, place="zone", place_is_optional=True, on_delay_s=1.0, spares_exclusions=True,
    ),
    Kind(
        "body.down",
        "Somebody is on the floor, hips below 0.35 m, and no fall was seen.",
        "ours; 30 s on the floor raises the severity",
        _down, place="zone", place_is_optional=True, on_delay_s=10.0, escalate_s=30.0,
        spares_exclusions=True,
    ),
    Kind(
        "ttc.vehicle",
        "Any joint that a camera supports is within `distance_m` of the moving volume; inside it "
        "counts at once, with a higher severity. Both are foreseen.",
        "3 s: horizon of pedestrians' interactions; distance: ours",
        _near_volume, place="volume", on_delay_s=0.1, early_s=3.0, can_warn=True,
        keys=(Key("distance_m", float, "So near is near [m].", 0.3, {"ge": 0.0, "le": 10.0}),),
    ),
    Kind(
        "volume.enter",
        "Any joint that a camera supports is inside the moving volume, once that has been on its "
        "way for `after_s`.",
        "ours: whoever is still on a chair behind the place to leave it",
        _on_volume, place="volume", on_delay_s=0.3,
        keys=(Key("after_s", float, "For how long the volume must have been on its way [s].", 0.0,
                  {"ge": 0.0, "le": 86400.0}),),
    ),
    Kind(
        "lift.unload",
        "A joint that a camera supports is inside a chair that has passed the line, or somebody is "
        "still in the strip when the next chair is less than `next_s` from the line; a person who "
        "lies there counts at once, with a higher severity.",
        "functions of commercial chairlift monitors; 3 s and delay: ours",
        _unloading, place="volume", on_delay_s=0.3,
        keys=(
            Key("line", str, "Where riders have to be off; chairs pass from its right to its left.",
                names="line"),
            Key("strip", str, "The zone that has to be clear when the next chair comes.",
                names="zone"),
            Key("next_s", float, "How long before the line a chair counts as coming [s].", 3.0,
                {"gt": 0.0, "le": 60.0}),
        ),
    ),
    Kind(
        "access.tailgate",
        "Somebody crosses the line in the authorised direction while all valid grants are used up.",
        "one credential, two bodies; 5 s: ours",
        _tailgated, place="line", at_once=True, keys=_GATE,
    ),
    Kind(
        "access.unauthorised",
        "Somebody crosses the line while no grant is valid, or against the authorised direction.",
        "5 s: ours",
        _unauthorised, place="line", at_once=True,
        keys=(
            *_GATE,
            Key("way_back", Literal["closed", "free"],
                'Whether everybody may pass in the other direction ("free").', "closed"),
        ),
    ),
    Kind(
        "zone.confined",
        "The floor point of somebody who has been inside the zone is outside.",
        "delay: confined area of NVIDIA behaviour analytics",
        _out_of_zone, place="zone", on_delay_s=0.5,
    ),
    Kind(
        "density.critical",
        "The Voronoi density in the zone is `density_pm2` or more; in the mean over 5 s "
        "`grave_pm2` or more it counts at once, with a higher severity.",
        "4 and 5 people/m2: Still, uncomfortable and dangerous; 5 s and least area of 4 m2: ours",
        _critical, place="zone", on_delay_s=5.0, is_about_place=True,
        keys=(
            Key("density_pm2", float, "The density [people/m2].", 4.0, _DENSITY),
            Key("grave_pm2", float, "The density that is worse [people/m2].", 5.0, _DENSITY),
        ),
    ),
    Kind(
        "crowd.pressure",
        "Where at least 4 people/m2 are packed, density times the variance of the velocities about "
        "the local flow is above `pressure_ps2`; above `grave_ps2` it counts at once, with a "
        "higher severity.",
        "0.02 /s2: Helbing, Johansson and Al-Abideen 2007; 0.04 and 3 s: ours",
        _pressed, place="zone", on_delay_s=3.0, is_about_place=True,
        keys=(
            Key("pressure_ps2", float, "The pressure [1/s2].", 0.02, {"gt": 0.0, "le": 10.0}),
            Key("grave_ps2", float, "The pressure that is worse [1/s2].", 0.04,
                {"gt": 0.0, "le": 10.0}),
        ),
    ),
    Kind(
        "flow.bottleneck",
        "While the density in the zone rises, fewer people leave it than `share` of the usual: "
        "over the last 10 s, against the last 60 s.",
        "ours",
        _clogged, place="zone", on_delay_s=10.0, is_about_place=True,
        keys=(Key("share", float, "The share of the usual flow.", 0.5, {"gt": 0.0, "lt": 1.0}),),
    ),
    Kind(
        "crowd.panic",
        "At least `people`, and `share` of all, begin to run within 2 s of each other.",
        "ours; running: as of speed.running",
        _panicking, place="zone", place_is_optional=True, on_delay_s=1.0, is_about_place=True,
        keys=(
            Key("people", int, "So many people.", 3, {"ge": 2, "le": 1000}),
            Key("share", float, "Such a share of all.", 0.3, {"ge": 0.0, "le": 1.0}),
            Key("speed_mps", float, "Who is faster runs [m/s].", 2.2, {"gt": 0.0, "le": 20.0}),
        ),
    ),
    Kind(
        "body.climb",
        "A foot is more than 0.35 m above the floor within 0.5 m of the zone, or the hips are over "
        "the zone and above its top: the zone is the barrier.",
        "ours",
        _climbing, place="zone", on_delay_s=0.4,
    ),
    Kind(
        "body.reach",
        "A wrist or elbow is inside the prism of the zone while the feet are outside.",
        "ours",
        _reaching, place="zone", on_delay_s=0.3,
    ),
    Kind(
        "body.distress",
        "Both wrists are 0.1 m above the head, or a raised hand has waved for 3 s, 0.5 to 3 times "
        "a second.",
        "ours",
        _distressed, place="zone", place_is_optional=True, on_delay_s=2.0,
    ),
    Kind(
        "group.split",
        "Somebody is farther than `distance_m` from everybody with whom they had walked for "
        "`together_s`.",
        "pairs: nearer than 1.5 m, velocities that differ by less than 0.4 m/s; in ETH/UCY such "
        "pairs are groups in 59 to 84 % of the cases",
        _separated, on_delay_s=15.0,
        keys=(
            Key("distance_m", float, "So far is far [m].", 8.0, {"gt": 0.0, "le": 1000.0}),
            Key("together_s", float, "Who walked together for so long belongs together [s].", 10.0,
                _SECONDS),
        ),
    ),
)  # fmt: skip

_OWN, OWN_FAULTS = own_kinds([kind.name for kind in _ALL])

KINDS = {kind.name: kind for kind in (*_ALL, *_OWN)}
"""All kinds of rules, by name: ours, and those that other packages bring."""

BUILT_IN = tuple(kind.name for kind in _ALL)
"""Names of the kinds that are part of trecsim."""
