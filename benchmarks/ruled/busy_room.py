"""A room in which all kinds of things happen, drawn at random: its site and its people.

Stops are at least 0.2 m away from every border, stays at least a second longer than the limit.
Three who wait make 0.37 to 0.41 people/m^2, four 0.47 to 0.52; level C begins at 0.43. Nobody walks
through anybody. Ways are not kept away from borders: who cuts a corner, cuts it.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from trecsim.lab.simulation.roles import Role, Visit
    from trecsim.lab.simulation.scene import Scene

SECONDS, FPS = 40.0, 20.0
ROOM_M = (10.0, 8.0, 3.0)  # width, depth, height of the cameras
APART_M = 0.5
TRIES = 40

SITE = """
format = "trecsim.site/1"
name = "busy-room"
[zones.lobby]
polygon_m = [[-1.6, -0.4], [0.4, -0.4], [0.4, 1.8], [-1.6, 1.8]]
[zones.wait]
polygon_m = [[1.6, 0.6], [4.0, 0.6], [4.0, 2.8], [1.6, 2.8]]
[zones.machine]
polygon_m = [[-4.2, 1.4], [-2.2, 1.4], [-2.2, 3.2], [-4.2, 3.2]]
[zones.lane]
polygon_m = [[-4.2, -2.2], [4.2, -2.2], [4.2, -0.9], [-4.2, -0.9]]
[lines.middle]
points_m = [[0.0, -2.4], [0.0, 3.4]]
[lines.door]
points_m = [[1.4, 3.4], [1.4, 0.4]]
[edges.platform]
points_m = [[4.5, -3.0], [-4.5, -3.0]]
[[rules]]
id = "lobby-in"
kind = "zone.enter"
zone = "lobby"
[[rules]]
id = "lobby-out"
kind = "zone.exit"
zone = "lobby"
[[rules]]
id = "wait-in"
kind = "zone.enter"
zone = "wait"
[[rules]]
id = "wait-out"
kind = "zone.exit"
zone = "wait"
[[rules]]
id = "wait-long"
kind = "zone.dwell"
zone = "wait"
dwell_s = 4.0
[[rules]]
id = "machine"
kind = "zone.restricted"
zone = "machine"
[[rules]]
id = "middle"
kind = "line.cross"
line = "middle"
[[rules]]
id = "door"
kind = "line.cross"
line = "door"
direction = "in"
[[rules]]
id = "wait-three"
kind = "occupancy.limit"
zone = "wait"
limit = 3
[[rules]]
id = "wait-dense"
kind = "density.level"
zone = "wait"
level = "C"
on_delay_s = 3.0
[[rules]]
id = "run"
kind = "speed.running"
[[rules]]
id = "against"
kind = "flow.wrong_way"
zone = "lane"
heading_deg = 0.0
[[rules]]
id = "platform"
kind = "edge.platform"
edge = "platform"
[[rules]]
id = "fall"
kind = "body.fall"
[[rules]]
id = "down"
kind = "body.down"
"""
SPOTS_M = ((2.25, 1.2), (3.35, 1.3), (2.25, 2.2), (3.35, 2.2))
OFF_SPOT_M = 0.07
"""Where people wait [m], and how far from there at most, per axis."""
Point = tuple[float, float]


def _u(rng: np.random.Generator, low: float, high: float) -> float:
    return round(float(rng.uniform(low, high)), 3)


def _visit(start_m: Point, actions: list[Any], enter_s: float, leaves: bool = True) -> "Visit":
    from trecsim.lab.simulation.roles import Visit

    return Visit(start_m, tuple(actions), None, enter_s, leaves)


def through_the_lobby(rng: np.random.Generator, at_s: float) -> "Visit":
    """Return a person who crosses the room through the lobby, with or without a stop, and back."""
    from trecsim.lab.simulation.actions import Stand, Walk

    west = -1.0 if rng.random() < 0.5 else 1.0
    y_m, speed = _u(rng, 0.2, 1.2), _u(rng, 0.8, 1.5)
    inside = (_u(rng, -1.2, -0.1), y_m)
    out = (3.9 * west, _u(rng, -0.4, 0.2))
    actions = [Walk((inside,), speed), Stand(_u(rng, 0.5, 3.0)), Walk((out,), speed)]
    return _visit((-3.9 * west, _u(rng, -0.4, 0.2)), actions, at_s)


def along_the_lane(rng: np.random.Generator, at_s: float) -> "Visit":
    """Return a person who walks along the lane, in the allowed direction or against it."""
    from trecsim.lab.simulation.actions import Walk

    way = 1.0 if rng.random() < 0.4 else -1.0
    y_m = _u(rng, -1.85, -1.25)
    return _visit((-4.3 * way, y_m), [Walk(((4.3 * way, y_m),), _u(rng, 0.9, 1.7))], at_s)


def runner(rng: np.random.Generator, at_s: float) -> "Visit":
    """Return a person who runs through the room."""
    from trecsim.lab.simulation.actions import Run

    way = 1.0 if rng.random() < 0.5 else -1.0
    y_m = _u(rng, -0.3, 0.1)
    return _visit((-4.4 * way, y_m), [Run(((4.4 * way, y_m),), _u(rng, 2.8, 4.0))], at_s)


def faller(rng: np.random.Generator, at_s: float) -> "Visit":
    """Return a person who falls and gets up after a while."""
    from trecsim.lab.simulation.actions import Fall, Stand, Walk

    spot = (_u(rng, -2.6, 2.6), _u(rng, -0.4, 0.2))
    side = str(rng.choice(("back", "front", "left", "right")))
    falls = Fall(_u(rng, 3.0, 7.0), side, _u(rng, 0.7, 1.1))  # type: ignore[arg-type]
    way_out = (4.2 * (1.0 if spot[0] > 0 else -1.0), _u(rng, -0.4, 0.2))
    actions = [Walk((spot,), _u(rng, 0.8, 1.4)), falls, Stand(1.0), Walk((way_out,), 0.9)]
    return _visit((-way_out[0], way_out[1]), actions, at_s)


def lies_down(rng: np.random.Generator, at_s: float) -> "Visit":
    """Return a person who lies down slowly and stays."""
    from trecsim.lab.simulation.actions import Lie, Walk

    spot = (_u(rng, -3.6, -2.6), _u(rng, -0.4, 0.4))
    side = str(rng.choice(("back", "left", "right")))
    lies = Lie(_u(rng, 12.0, 15.0), side)  # type: ignore[arg-type]
    return _visit((-4.3, 0.0), [Walk((spot,), 0.9), lies, Walk(((-4.3, 0.1),), 0.9)], at_s)


def waits(rng: np.random.Generator, at_s: float) -> list["Visit"]:
    """Return three or four people who come into the waiting area, wait, and go."""
    from trecsim.lab.simulation.actions import Stand, Walk

    people = []
    for n in range(int(rng.integers(3, 5))):
        off_m = _u(rng, -OFF_SPOT_M, OFF_SPOT_M), _u(rng, -OFF_SPOT_M, OFF_SPOT_M)
        spot = (SPOTS_M[n][0] + off_m[0], SPOTS_M[n][1] + off_m[1])
        door = (4.8, spot[1]) if n % 2 else (0.9, spot[1])
        stays = Stand(_u(rng, 8.0, 12.0))
        actions = [Walk((spot,), _u(rng, 0.8, 1.2)), stays, Walk((door,), _u(rng, 0.8, 1.2))]
        people.append(_visit(door, actions, at_s + _u(rng, 0.0, 2.0)))
    return people


def at_the_edge(rng: np.random.Generator, at_s: float) -> "Visit":
    """Return a person who walks up to the edge and stops, crosses it, or keeps away from it."""
    from trecsim.lab.simulation.actions import Stand, Walk

    x_m = _u(rng, -3.0, 3.0)
    y_m = float(rng.choice((-2.72, -3.35, -2.15)))
    actions = [
        Walk(((x_m, y_m),), _u(rng, 0.7, 1.1)), Stand(_u(rng, 3.5, 5.0)), Walk(((x_m, -0.5),), 0.9),
    ]  # fmt: skip
    return _visit((x_m, -0.5), actions, at_s)


def at_the_machine(rng: np.random.Generator, at_s: float) -> "Visit":
    """Return a person who walks up to the machine from 3 m away, or past it."""
    from trecsim.lab.simulation.actions import Stand, Walk

    if rng.random() < 0.7:
        inside = (_u(rng, -3.7, -2.7), _u(rng, 2.0, 2.7))
        actions = [
            Walk((inside,), _u(rng, 0.7, 1.3)), Stand(_u(rng, 1.0, 3.0)), Walk(((-1.6, 2.6),), 1.0),
        ]  # fmt: skip
        return _visit((1.0, _u(rng, 2.4, 2.7)), actions, at_s)
    return _visit((-1.5, 3.0), [Walk(((-1.5, 2.3), (-1.4, 2.0)), _u(rng, 0.7, 1.3))], at_s)


SINGLE = (through_the_lobby, along_the_lane, runner, faller, at_the_edge, at_the_machine)


def roles(seed: int) -> "tuple[Role, ...]":
    """Return people to whom all of it happens within `SECONDS`, each in turn, drawn by a seed."""
    from trecsim.lab.simulation.roles import Role

    rng = np.random.default_rng([seed, 12])
    chosen: list[Visit] = []
    ways_m: list[np.ndarray] = []
    todo: list[Any] = [
        waits, lies_down if seed % 2 else faller, faller, runner, at_the_edge, at_the_machine,
        at_the_machine, through_the_lobby, through_the_lobby, along_the_lane, along_the_lane,
    ]  # fmt: skip
    for act in todo:
        for _ in range(TRIES):
            made = act(rng, _u(rng, 0.0, 16.0 if act in (waits, lies_down) else 28.0))
            visits = made if isinstance(made, list) else [made]
            new_m = [_way_m(visit) for visit in visits]
            if _apart_m(new_m, ways_m) > APART_M:
                chosen, ways_m = chosen + visits, ways_m + new_m
                break
    return tuple(Role((visit,)) for visit in chosen)


def _way_m(visit: "Visit") -> np.ndarray:
    """Return where the hips of somebody are, a few times a second [m]."""
    from trecsim.lab.simulation.body_shape import body

    return visit.motion(body(1.75), SECONDS, 0.0)(np.arange(0.0, SECONDS, 0.2))[:, 11, :2]


def _apart_m(new_m: list[np.ndarray], others_m: list[np.ndarray]) -> float:
    """Return how near the new ones ever are to each other and to the others [m]."""
    pairs = [(a, b) for n, a in enumerate(new_m) for b in (*new_m[:n], *others_m)]
    apart_m = [np.linalg.norm(a - b, axis=1) for a, b in pairs]
    known_m = np.concatenate([one[np.isfinite(one)] for one in apart_m] or [np.zeros(0)])
    return float(known_m.min()) if len(known_m) else np.inf


def busy_room(seed: int, cameras: int = 4) -> "Scene":
    """Return the scene of a seed."""
    from trecsim.lab.simulation.camera_clocks import Clock
    from trecsim.lab.simulation.people import ScriptedPeople
    from trecsim.lab.simulation.room import corner_rig
    from trecsim.lab.simulation.scene import Scene

    clocks = tuple(Clock(FPS, start_s=(0.37 * n % 1.0) / FPS) for n in range(cameras))
    return Scene(corner_rig(*ROOM_M, cameras), ScriptedPeople(roles(seed)), SECONDS, clocks=clocks)
