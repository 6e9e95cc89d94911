"""A small station on a normal day: its site with 25 kinds of rules, and who comes at which hour.

People come in through a gate with tickets or up the stairs, wait, sit, look about, bend, crouch,
tie a shoe, raise an arm, walk along the platform at least 0.3 m behind its line (which is 0.5 m
from the edge), and leave. Nobody falls, runs, enters what is closed, or passes without a ticket.
Nobody walks through anybody. A train passes without a stop.
"""

import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from trecsim.lab.simulation.roles import Role, Visit
    from trecsim.lab.simulation.scene import Scene

PIECE_S, FPS, CAMERAS = 900.0, 8.0, 4
ROOM_M = (10.0, 8.0, 3.0)  # width, depth, height of the cameras
PER_PIECE = (
    0.4, 0.3, 0.2, 0.2, 0.4, 1.5, 7.0, 40.0, 40.0, 9.0, 5.0, 7.0,
    9.0, 7.0, 5.0, 7.0, 14.0, 40.0, 14.0, 7.0, 4.0, 3.0, 1.5, 0.8,
)  # fmt: skip
"""How many people come in a quarter of an hour, in the mean, for each hour of the day."""
APART_M, LOOK_HZ, TRIES = 0.5, 5.0, 12
PAIRS = 0.15
"""Share of people who come in pairs."""
LONGEST_S = 400.0
FEED_NAME, FEED = "tickets", "tickets.jsonl"
BEATS_S = 10.0
GATE_X_M = -3.4
SITE = f"""
format = "trecsim.site/1"
name = "station"
[zones.station]
polygon_m = [[-6.0, -2.8], [6.0, -2.8], [6.0, 4.0], [-6.0, 4.0]]
[zones.benches]
polygon_m = [[-1.8, 1.5], [2.0, 1.5], [2.0, 3.2], [-1.8, 3.2]]
[zones.platform]
polygon_m = [[-4.4, -2.8], [4.4, -2.8], [4.4, -1.1], [-4.4, -1.1]]
[zones.machine]
polygon_m = [[-4.4, 1.9], [-2.6, 1.9], [-2.6, 3.3], [-4.4, 3.3]]
[zones.counter]
polygon_m = [[3.4, 0.9], [4.6, 0.9], [4.6, 1.4], [3.4, 1.4]]
z_m = [0.0, 1.1]
[zones.way-out]
polygon_m = [[2.6, -1.0], [4.6, -1.0], [4.6, 0.4], [2.6, 0.4]]
[lines.gate]
points_m = [[{GATE_X_M}, 0.9], [{GATE_X_M}, -0.9]]
[lines.stairs]
points_m = [[3.2, 3.2], [3.2, 1.8]]
[edges.platform]
points_m = [[4.8, -2.8], [-4.8, -2.8]]
[feeds.{FEED_NAME}]
file = "{FEED}"
[volumes.train]
size_m = [24.0, 2.6, 3.5]
bottom_m = 0.0
path_m = [[-160.0, -4.35], [160.0, -4.35]]
path_s = [0.0, 20.0]
start_s = 140.0
period_s = 300.0
""" + "".join(
    f'[[rules]]\nid = "{kind.replace(".", "-")}"\nkind = "{kind}"\n{keys}\n'
    for kind, keys in (
        ("zone.enter", 'zone = "benches"'),
        ("zone.exit", 'zone = "benches"'),
        ("zone.dwell", 'zone = "benches"'),
        ("zone.restricted", 'zone = "machine"'),
        ("zone.confined", 'zone = "station"'),
        ("line.cross", 'line = "stairs"'),
        ("occupancy.limit", 'zone = "station"\nlimit = 16'),
        ("density.level", 'zone = "benches"'),
        ("density.critical", 'zone = "platform"'),
        ("crowd.pressure", 'zone = "platform"'),
        ("flow.bottleneck", 'zone = "way-out"'),
        ("flow.wrong_way", 'zone = "way-out"\nheading_deg = 0.0'),
        ("speed.running", ""),
        ("crowd.panic", ""),
        ("edge.platform", 'edge = "platform"'),
        ("ttc.vehicle", 'volume = "train"'),
        ("volume.enter", 'volume = "train"'),
        ("body.fall", ""),
        ("body.down", ""),
        ("body.climb", 'zone = "counter"'),
        ("body.reach", 'zone = "counter"'),
        ("body.distress", ""),
        ("group.split", ""),
        ("access.tailgate", f'line = "gate"\nfeed = "{FEED_NAME}"'),
        ("access.unauthorised", f'line = "gate"\nfeed = "{FEED_NAME}"'),
    )
)
UP, DOWN = 90.0, -90.0
"""Directions away from the edge and towards it [degrees]."""
SEATS_M = (-1.0, -0.2, 0.6, 1.4)
"""Where the seats are, along the wall behind the benches [m]."""
SEAT_Y_M = 2.4
Point = tuple[float, float]


class Piece(NamedTuple):
    """A quarter of an hour.

    Attributes
    ----------
    roles
        Who comes, packed: each role is several people, one after the other.
    messages
        Of the ticket reader, lines of JSON.
    """

    roles: "tuple[Role, ...]"
    messages: str


def _u(rng: np.random.Generator, low: float, high: float) -> float:
    return round(float(rng.uniform(low, high)), 3)


def _way_in(rng: np.random.Generator, pair: bool) -> tuple[Point, list[Point]]:
    """Return where a person appears, through the gate or up the stairs, and the first waypoints."""
    if rng.random() < 0.6:
        y_m = _u(rng, 0.3, 0.45) if pair else _u(rng, -0.5, 0.5)
        return (-4.6, y_m), [(-2.7, y_m)]
    y_m = _u(rng, 2.85, 3.0) if pair else _u(rng, 2.1, 2.9)
    return (4.6, y_m), [(2.8, y_m)]


def _way_out(rng: np.random.Generator, pair: bool) -> list[Point]:
    if rng.random() < 0.7:
        y_m = _u(rng, 0.0, 0.1) if pair else _u(rng, -0.8, 0.1)
        return [(2.4, y_m), (4.6, y_m)]
    y_m = _u(rng, 2.85, 3.0) if pair else _u(rng, 2.1, 2.9)
    return [(2.8, y_m), (4.6, y_m)]


def _looks_about(rng: np.random.Generator) -> list[Any]:
    from trecsim.lab.simulation.actions import Stand, Turn

    by_deg = float(rng.choice((-1.0, 1.0))) * _u(rng, 30.0, 110.0)
    return [Turn(by_deg), Stand(_u(rng, 2.0, 10.0)), Turn(-by_deg)]


def _does(rng: np.random.Generator, free_deg: float) -> list[Any]:
    """Return what a person does while standing: mostly nothing.

    Kneeling takes a long step forward, so people first turn to `free_deg`, where there is room.
    """
    from trecsim.lab.simulation.actions import Bend, Crouch, Kneel, RaiseArms, Turn

    what = str(rng.choice(("look", "nothing", "pick up", "shoe", "crouch", "arm"),
                          p=(0.4, 0.25, 0.12, 0.08, 0.07, 0.08)))  # fmt: skip
    if what == "look":
        return _looks_about(rng)
    if what == "pick up":
        return [Bend(_u(rng, 0.5, 2.0), _u(rng, 60.0, 95.0))]
    if what == "shoe":
        return [Turn(to_deg=free_deg), Kneel(_u(rng, 4.0, 10.0), 50.0)]
    if what == "crouch":
        return [Crouch(_u(rng, 1.0, 7.0))]
    if what == "arm":
        return [RaiseArms(_u(rng, 0.5, 2.5), "left" if rng.random() < 0.5 else "right")]
    return []


def _waits(rng: np.random.Generator, longest_s: float, free_deg: float) -> list[Any]:
    from trecsim.lab.simulation.actions import Stand

    return [Stand(_u(rng, 2.0, longest_s)), *_does(rng, free_deg), Stand(_u(rng, 1.0, longest_s))]


def _stop(rng: np.random.Generator, pair: bool, speed: float) -> list[Any]:
    """Return a walk to a place, and what the person does there."""
    from trecsim.lab.simulation.actions import Sit, Stand, Turn, Walk

    where = str(rng.choice(("hall", "platform", "along", "bench", "machine"),
                           p=(0.3, 0.25, 0.15, 0.25, 0.05)))  # fmt: skip
    if pair and where in ("bench", "machine"):
        where = "hall"
    if where == "bench":
        spot = (float(rng.choice(SEATS_M)), SEAT_Y_M)
        sits = [Sit(_u(rng, 20.0, 200.0), _u(rng, 0.38, 0.5)), Stand(_u(rng, 0.5, 3.0))]
        return [Walk(((spot[0], 1.4), spot), speed), Turn(to_deg=-90.0), *sits,
                Walk(((spot[0], 1.3),), speed)]  # fmt: skip
    if where == "machine":
        spot = (_u(rng, -2.2, -2.0), _u(rng, 2.0, 2.4))
        return [
            Walk(((-2.1, 1.0), spot), speed),
            *_waits(rng, 8.0, DOWN),
            Walk(((-2.0, 1.0),), speed),
        ]
    if where == "hall":
        y_m = _u(rng, 0.5, 1.2) if pair else _u(rng, -0.8, 1.2)
        return [Walk(((_u(rng, -2.2, 2.2), y_m),), speed), *_waits(rng, 30.0, UP)]
    y_m = -1.25 if pair else _u(rng, -1.95, -1.2)
    x_m = _u(rng, -3.8, 3.8)
    walks = [Walk(((x_m, y_m),), speed), *_waits(rng, 45.0, UP)]
    if where == "along":
        walks += [Walk(((_u(rng, -3.8, 3.8), y_m),), speed), *_waits(rng, 20.0, UP)]
    return walks


def visit(rng: np.random.Generator, pair: bool) -> "Visit":
    """Return somebody who comes, stays a while and leaves; with room at the right, for a pair."""
    from trecsim.lab.simulation.actions import Walk
    from trecsim.lab.simulation.roles import Visit

    speed = float(np.clip(rng.normal(1.3, 0.2), 0.6, 1.9))
    start_m, first_m = _way_in(rng, pair)
    actions = [Walk(tuple(first_m), speed)]
    for _ in range(int(rng.integers(0, 4))):
        actions += _stop(rng, pair, speed)
    actions.append(Walk(tuple(_way_out(rng, pair)), speed))
    return Visit(start_m, tuple(actions), None, 0.0, leaves=True)


class Way(NamedTuple):
    """When and where the hips of somebody are, `LOOK_HZ` times a second."""

    first: int
    xy_m: np.ndarray

    def later(self, by: int) -> "Way":
        """Return the same way so many looks later."""
        return Way(self.first + by, self.xy_m)

    @property
    def end(self) -> int:
        """Return the first look after it."""
        return self.first + len(self.xy_m)


def _way(one: "Visit") -> Way:
    """Return the way of somebody from when they appear."""
    from trecsim.lab.simulation.body_shape import body

    t_s = np.arange(0.0, LONGEST_S + 60.0, 1.0 / LOOK_HZ)
    at_once = replace(one, enter_s=0.0)
    hips_m = at_once.motion(body(1.75), LONGEST_S + 60.0, 0.0)(t_s)[:, 11, :2]
    return Way(0, hips_m[np.isfinite(hips_m[:, 0])])


def apart_m(one: Way, other: Way) -> float:
    """Return how near two people ever are to each other [m]."""
    begin, end = max(one.first, other.first), min(one.end, other.end)
    if begin >= end:
        return np.inf
    way_m = one.xy_m[begin - one.first : end - one.first]
    return float(
        np.linalg.norm(way_m - other.xy_m[begin - other.first : end - other.first], axis=1).min()
    )


def visits(
    hour: int, rng: np.random.Generator, seconds: float = PIECE_S
) -> "list[tuple[Visit, Way]]":
    """Return who comes in a piece of the day, and their ways; all have left when it ends."""
    chosen: list[tuple[Visit, Way]] = []
    for _ in range(int(rng.poisson(PER_PIECE[hour] * seconds / PIECE_S))):
        for _ in range(TRIES):
            found = _placed(rng, chosen, seconds)
            if found:
                chosen += found
                break
    return sorted(chosen, key=lambda each: each[1].first)


def _placed(
    rng: np.random.Generator, others: "list[tuple[Visit, Way]]", seconds: float
) -> "list[tuple[Visit, Way]]":
    """Return one or two who come at a time at which they are in nobody's way; or none."""
    pair = bool(rng.random() < PAIRS)
    one = visit(rng, pair)
    both = [one, one.shifted((0.0, -0.7))] if pair else [one]
    ways = [_way(each) for each in both]
    longest_s = max(way.end for way in ways) / LOOK_HZ
    if longest_s > min(LONGEST_S, seconds - 4.0):
        return []
    for _ in range(TRIES):
        first = int(rng.integers(0, int((seconds - 2.0 - longest_s) * LOOK_HZ)))
        moved = [way.later(first) for way in ways]
        if all(apart_m(a, b) > APART_M for a in moved for _, b in others):
            return [
                (replace(each, enter_s=first / LOOK_HZ), way)
                for each, way in zip(both, moved, strict=True)
            ]
    return []


def piece(hour: int, seed: int, seconds: float = PIECE_S) -> Piece:
    """Return who comes in a piece of the day, and what the ticket reader says."""
    who = visits(hour, np.random.default_rng([seed, 25]), seconds)
    return Piece(_packed(who), _tickets(who, seconds))


def _packed(who: "list[tuple[Visit, Way]]") -> "tuple[Role, ...]":
    """Return roles of which each is several people, one after the other: fewer rows of arrays."""
    from trecsim.lab.simulation.roles import Role

    rows: list[tuple[list[Visit], float]] = []
    for one, way in who:
        gone_s = way.end / LOOK_HZ + 1.0
        free = next((n for n, (_, until_s) in enumerate(rows) if until_s < one.enter_s), None)
        if free is None:
            rows.append(([one], gone_s))
        else:
            rows[free] = ([*rows[free][0], one], gone_s)
    return tuple(Role(tuple(several)) for several, _ in rows)


def _tickets(who: "list[tuple[Visit, Way]]", seconds: float) -> str:
    """Return a message for each who passes the gate, and signs of life."""
    messages: list[dict[str, Any]] = [
        {"t_s": float(t_s)} for t_s in np.arange(0.0, seconds, BEATS_S)
    ]
    for one, way in who:
        if one.start_m[0] < GATE_X_M:
            crossed = int(np.argmax(way.xy_m[:, 0] > GATE_X_M))
            messages.append({"t_s": one.enter_s + crossed / LOOK_HZ - 0.6, "grant": "gate"})
    messages.sort(key=lambda message: message["t_s"])
    return "\n".join(json.dumps(message) for message in messages)


def scene(roles: "tuple[Role, ...]", seconds: float = PIECE_S) -> "Scene":
    """Return the scene of a piece."""
    from trecsim.lab.simulation.camera_clocks import Clock
    from trecsim.lab.simulation.people import ScriptedPeople
    from trecsim.lab.simulation.room import corner_rig
    from trecsim.lab.simulation.scene import Scene

    clocks = tuple(Clock(FPS, start_s=(0.37 * n % 1.0) / FPS) for n in range(CAMERAS))
    return Scene(corner_rig(*ROOM_M, CAMERAS), ScriptedPeople(roles), seconds, clocks=clocks)


def one_by_one(xyz_m: np.ndarray) -> np.ndarray:
    """Return the truth with a row for each visit, from one with several visits in a row.

    Parameters
    ----------
    xyz_m
        Person, time, joint, axis; NaN while nobody is there [m].
    """
    rows = []
    for one_m in xyz_m:
        there = np.isfinite(one_m[:, 0, 0])
        starts = np.flatnonzero(there & ~np.append(False, there[:-1]))
        ends = np.flatnonzero(there & ~np.append(there[1:], False)) + 1
        for begin, end in zip(starts, ends, strict=True):
            row = np.full_like(one_m, np.nan)
            row[begin:end] = one_m[begin:end]
            rows.append(row)
    return np.array(rows) if rows else np.empty((0, *xyz_m.shape[1:]))
