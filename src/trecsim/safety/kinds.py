"""The table of all kinds of rules: their keys, their defaults, and where the numbers come from."""

from typing import Literal

from trecsim.safety import condition_makers as make
from trecsim.safety.conditions.density import Level
from trecsim.safety.own_kinds import own_kinds
from trecsim.safety.rule import Key, Kind
from trecsim.safety.signals import LONGEST_S

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
        make.in_zone, place="zone", on_delay_s=0.2, can_warn=True,
    ),
    Kind(
        "zone.exit",
        "The floor point has left the zone: it is 0.15 m outside.",
        "delay as of zone.enter; distance: ours",
        make.left, place="zone", on_delay_s=0.2, at_once=True,
    ),
    Kind(
        "zone.dwell",
        "The floor point has been inside the zone for `dwell_s`; gaps up to 2 s are bridged.",
        "60 s as i-LIDS for parked vehicles; three times as long raises the severity: ours",
        make.in_zone, place="zone", off_delay_s=2.0, gap_s=2.0, escalate_s=3.0, hold_key="dwell_s",
        keys=(Key("dwell_s", float, "How long somebody may be in the zone [s].", 60.0, _SECONDS),),
    ),
    Kind(
        "zone.restricted",
        "Any joint that a camera supports is inside the prism of the zone.",
        "delay: restricted area of NVIDIA behaviour analytics, 0.1 s",
        make.joint_in_zone, place="zone", on_delay_s=0.1, early_s=2.0, can_warn=True,
    ),
    Kind(
        "line.cross",
        "The floor point has crossed the line: it is 0.15 m on the other side.",
        "distance: ours",
        make.crossed, place="line", at_once=True,
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
        make.occupied, place="zone", on_delay_s=2.0, is_about_place=True,
        keys=(Key("limit", int, "The number of people.", limits={"ge": 1, "le": 10_000}),),
    ),
    Kind(
        "density.level",
        "The Voronoi density in the zone is at a level of service of walkways or above; level F "
        "with people who move counts at once, with a higher severity.",
        "levels: Fruin; delay and least area of 4 m2: ours",
        make.dense, place="zone", on_delay_s=10.0, is_about_place=True,
        keys=(Key("level", Level, "From which level on.", "E"),),
    ),
    Kind(
        "speed.running",
        "The median speed of the hips over the last second is above `speed_mps`.",
        "2.2 m/s: pedestrians walk at 1.5 m/s (median), nine in ten below 1.8 m/s in ETH/UCY",
        make.running, place="zone", place_is_optional=True, on_delay_s=0.8,
        keys=(Key("speed_mps", float, "The speed [m/s].", 2.2, {"gt": 0.0, "le": 20.0}),),
    ),
    Kind(
        "flow.wrong_way",
        "The hips move against `heading_deg` in the zone: faster than 0.5 m/s, over 1.5 m.",
        "ours",
        make.wrong_way, place="zone", on_delay_s=1.0,
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
        make.at_edge, place="edge", on_delay_s=2.0, early_s=2.0, can_warn=True,
        keys=(
            Key("distance_m", float, "Distance that counts as near [m].", 0.5,
                {"gt": 0.0, "le": 100.0}),
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
        make.fallen, place="zone", place_is_optional=True, on_delay_s=1.0, spares_exclusions=True,
    ),
    Kind(
        "body.down",
        "Somebody is on the floor, hips below 0.35 m, and no fall was seen.",
        "ours; 30 s on the floor raises the severity",
        make.down, place="zone", place_is_optional=True, on_delay_s=10.0, escalate_s=30.0,
        spares_exclusions=True,
    ),
    Kind(
        "ttc.vehicle",
        "Any joint that a camera supports is within `distance_m` of the moving volume; inside it "
        "counts at once, with a higher severity. Both are foreseen.",
        "3 s: horizon of pedestrians' interactions; distance: ours",
        make.near_volume, place="volume", on_delay_s=0.1, early_s=3.0, can_warn=True,
        keys=(Key("distance_m", float, "Distance that counts as near [m].", 0.3,
                  {"ge": 0.0, "le": 10.0}),),
    ),
    Kind(
        "volume.enter",
        "Any joint that a camera supports is inside the moving volume, once that has been on its "
        "way for `after_s`.",
        "ours: people who are still on a chair beyond the place to leave it",
        make.on_volume, place="volume", on_delay_s=0.3,
        keys=(Key("after_s", float, "For how long the volume must have been on its way [s].", 0.0,
                  {"ge": 0.0, "le": 86400.0}),),
    ),
    Kind(
        "lift.unload",
        "A joint that a camera supports is inside a chair that has passed the line, or somebody is "
        "still in the strip when the next chair is less than `next_s` from the line; a person who "
        "lies there counts at once, with a higher severity.",
        "functions of commercial chairlift monitors; 3 s and delay: ours",
        make.unloading, place="volume", on_delay_s=0.3,
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
        make.tailgated, place="line", at_once=True, keys=_GATE,
    ),
    Kind(
        "access.unauthorised",
        "Somebody crosses the line while no grant is valid, or against the authorised direction.",
        "5 s: ours",
        make.unauthorised, place="line", at_once=True,
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
        make.out_of_zone, place="zone", on_delay_s=0.5,
    ),
    Kind(
        "density.critical",
        "The Voronoi density in the zone is `density_pm2` or more; in the mean over 5 s "
        "`grave_pm2` or more it counts at once, with a higher severity.",
        "4 and 5 people/m2: Still, uncomfortable and dangerous; 5 s and least area of 4 m2: ours",
        make.critical, place="zone", on_delay_s=5.0, is_about_place=True,
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
        make.pressed, place="zone", on_delay_s=3.0, is_about_place=True,
        keys=(
            Key("pressure_ps2", float, "The pressure [1/s2].", 0.02, {"gt": 0.0, "le": 10.0}),
            Key("grave_ps2", float, "The pressure that is worse [1/s2].", 0.04,
                {"gt": 0.0, "le": 10.0}),
        ),
    ),
    Kind(
        "flow.bottleneck",
        "While the density in the zone rises and is `density_pm2` or more, fewer people leave it "
        "than `share` of the usual: over the last 10 s, against the last 60 s.",
        "ours; 0.72 people/m2: Fruin, walkways, level D",
        make.clogged, place="zone", on_delay_s=10.0, is_about_place=True,
        keys=(
            Key("share", float, "The share of the usual flow.", 0.5, {"gt": 0.0, "lt": 1.0}),
            Key("density_pm2", float, "The least density [people/m2].", 0.72, _DENSITY),
        ),
    ),
    Kind(
        "crowd.panic",
        "At least `people`, and `share` of all, begin to run within 2 s of each other.",
        "ours; running: as of speed.running",
        make.panicking, place="zone", place_is_optional=True, on_delay_s=1.0, is_about_place=True,
        keys=(
            Key("people", int, "The number of people.", 3, {"ge": 2, "le": 1000}),
            Key("share", float, "Their share of all people.", 0.3, {"ge": 0.0, "le": 1.0}),
            Key("speed_mps", float, "Least speed of running [m/s].", 2.2, {"gt": 0.0, "le": 20.0}),
        ),
    ),
    Kind(
        "body.climb",
        "A foot is more than 0.35 m above the floor within 0.5 m of the zone, or the hips are over "
        "the zone and above its top: the zone is the barrier.",
        "ours",
        make.climbing, place="zone", on_delay_s=0.4,
    ),
    Kind(
        "body.reach",
        "A wrist or elbow is inside the prism of the zone while the feet are outside.",
        "ours",
        make.reaching, place="zone", on_delay_s=0.3,
    ),
    Kind(
        "body.distress",
        "Both wrists are 0.1 m above the head, or a raised hand has waved for 3 s, 0.5 to 3 times "
        "a second.",
        "ours",
        make.distressed, place="zone", place_is_optional=True, on_delay_s=2.0,
    ),
    Kind(
        "group.split",
        "Somebody is farther than `distance_m` from everybody with whom they had walked for "
        "`together_s`.",
        "pairs: nearer than 1.5 m, velocities that differ by less than 0.4 m/s; in ETH/UCY such "
        "pairs are groups in 59 to 84 % of the cases; walking, 0.3 m/s: ours",
        make.separated, on_delay_s=15.0,
        keys=(
            Key("distance_m", float, "Distance that counts as far [m].", 8.0,
                {"gt": 0.0, "le": 1000.0}),
            Key("together_s", float, "Time of walking together that makes a group [s].", 10.0,
                _SECONDS),
        ),
    ),
)  # fmt: skip

_OWN, OWN_FAULTS = own_kinds([kind.name for kind in _ALL])

KINDS = {kind.name: kind for kind in (*_ALL, *_OWN)}
"""All kinds of rules, by name: ours, and those that other packages bring."""

BUILT_IN = tuple(kind.name for kind in _ALL)
"""Names of the kinds that are part of trecsim."""
