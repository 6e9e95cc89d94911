"""A gate with a ticket reader, a lift that unloads, and a bed, drawn at random: site and people.

People pass the gate one by one: with a ticket, without one, close behind a person with one, or
the wrong way out. Riders get off a chair and leave the strip, or stay in it. One lies down on the
bed, which is nothing, and one falls beside it or onto it.
"""

import json
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, cast

import numpy as np

if TYPE_CHECKING:
    from trecsim.lab.simulation.roles import Visit
    from trecsim.lab.simulation.scene import Scene

SECONDS, FPS = 40.0, 20.0
ROOM_M = (10.0, 8.0, 3.0)  # width, depth, height of the cameras
FEED_NAME, FEED = "tickets", "tickets.jsonl"
"""The feed of the ticket reader in the site file, and its file."""
GATE_S, CHAIR_S = 5.5, 8.0
"""From one who passes to the next, and from chair to chair [s]."""
_CHAIR_START_S, _CHAIR_MPS = 1.0, 1.2
SITE = f"""
format = "trecsim.site/1"
name = "gate-room"
[zones.strip]
polygon_m = [[0.2, -3.4], [3.0, -3.4], [3.0, -1.6], [0.2, -1.6]]
[zones.bedside]
polygon_m = [[-4.6, 1.2], [4.6, 1.2], [4.6, 3.8], [-4.6, 3.8]]
[lines.gate]
points_m = [[0.0, 0.9], [0.0, -0.9]]
[lines.off]
points_m = [[0.2, -1.6], [0.2, -3.4]]
[exclusions.bed]
polygon_m = [[0.8, 1.6], [4.4, 1.6], [4.4, 3.6], [0.8, 3.6]]
[feeds.{FEED_NAME}]
file = "{FEED}"
silent_s = 12.0
[volumes.chair]
size_m = [0.9, 1.4, 1.2]
bottom_m = 0.45
path_m = [[-4.0, -2.5], [0.2, -2.5], [0.6, -2.5]]
path_s = [0.0, {4.2 / _CHAIR_MPS:.3f}, {4.2 / _CHAIR_MPS + 1.0:.3f}]
start_s = {_CHAIR_START_S}
period_s = {CHAIR_S}
[[rules]]
id = "follows"
kind = "access.tailgate"
line = "gate"
feed = "tickets"
[[rules]]
id = "unasked"
kind = "access.unauthorised"
line = "gate"
feed = "tickets"
[[rules]]
id = "unload"
kind = "lift.unload"
volume = "chair"
line = "off"
strip = "strip"
[[rules]]
id = "fall"
kind = "body.fall"
zone = "bedside"
[[rules]]
id = "down"
kind = "body.down"
zone = "bedside"
"""


class GateRoom(NamedTuple):
    """The scene of a seed, and the messages of its ticket reader, lines of JSON."""

    scene: "Scene"
    messages: str


def _u(rng: np.random.Generator, low: float, high: float) -> float:
    return round(float(rng.uniform(low, high)), 3)


def _visit(start_m: tuple[float, float], actions: list[Any], enter_s: float) -> "Visit":
    from trecsim.lab.simulation.roles import Visit

    return Visit(start_m, tuple(actions), None, enter_s, True)


def _crosses_s(visit: "Visit") -> float:
    """Return when a person's hips are on the line of the gate [s]."""
    from trecsim.lab.simulation.body_shape import body

    t_s = np.arange(0.0, SECONDS, 0.02)
    x_m = visit.motion(body(1.75), SECONDS, 0.0)(t_s)[:, 11, 0]
    sides = np.sign(x_m[:-1]) * np.sign(x_m[1:])
    crossed = np.flatnonzero(sides < 0)
    return float(t_s[crossed[0]]) if len(crossed) else float("nan")


def at_the_gate(rng: np.random.Generator) -> "tuple[list[Visit], list[dict[str, Any]]]":
    """Return who passes the gate, and what the ticket reader says."""
    from trecsim.lab.simulation.actions import Walk

    visits, messages = [], []
    for n in range(int(SECONDS / GATE_S) - 1):
        kind = rng.choice(("ticket", "ticket", "none", "two", "out"))
        way = -1.0 if kind == "out" else 1.0
        at_s, speed = 0.5 + n * GATE_S + _u(rng, 0.0, 0.4), _u(rng, 1.0, 1.4)
        y_m = -0.45 * way + _u(rng, -0.15, 0.15)  # each direction on its own side
        visit = _visit((-3.0 * way, y_m), [Walk(((3.0 * way, y_m),), speed)], at_s)
        visits.append(visit)
        crosses_s = _crosses_s(visit)
        if kind in ("ticket", "two"):
            messages.append({"t_s": crosses_s - _u(rng, 0.5, 1.5), "grant": "gate"})
        if kind == "two":
            behind_s = _u(rng, 0.65, 1.2) / speed
            walk = [Walk(((3.0 * way, y_m),), speed)]
            visits.append(_visit((-3.0 * way, y_m), walk, at_s + behind_s))
        messages.append({"t_s": crosses_s + 2.0, "closed": "gate"})
    return visits, messages


def off_the_chairs(rng: np.random.Generator) -> "list[Visit]":
    """Return riders who leave the strip, or stay in it until after the next chair."""
    from trecsim.lab.simulation.actions import Stand, Walk

    visits = []
    for n in range(int(SECONDS / CHAIR_S) - 1):
        at_s = _CHAIR_START_S + n * CHAIR_S - 0.9  # a good metre ahead of the middle of the chair
        y_m = _u(rng, -2.8, -2.2)
        actions: list[Any] = [Walk(((1.4, y_m),), _CHAIR_MPS + 0.1)]
        if rng.random() < 0.5:
            actions.append(Stand(_u(rng, 5.0, 5.8)))
        actions.append(Walk(((4.6, -2.9),), 1.2))
        visits.append(_visit((-4.0, y_m), actions, max(at_s, 0.0)))
    return visits


def at_the_bed(rng: np.random.Generator) -> "list[Visit]":
    """Return a person who lies down on the bed for a while, and one who falls."""
    from trecsim.lab.simulation.actions import Fall, Lie, Walk

    lies = [Walk(((2.6, 2.6),), 0.9), Lie(_u(rng, 13.0, 16.0), "back"), Walk(((4.8, 2.6),), 0.9)]
    beside = (_u(rng, -3.2, -1.6), _u(rng, 2.2, 2.8))
    lies_s = _u(rng, 3.0, 6.0)
    side = cast('Literal["left", "right"]', str(rng.choice(("left", "right"))))
    falls = Fall(lies_s, side, _u(rng, 0.7, 1.1))
    fell = _visit((-4.6, 2.0), [Walk((beside,), 1.0), falls, Walk(((-4.6, 2.0),), 0.9)], 3.0)
    return [_visit((4.8, 2.6), lies, 1.0), fell]


def gate_room(seed: int, cameras: int = 4) -> GateRoom:
    """Return the scene of a seed, and what its ticket reader says."""
    from trecsim.lab.simulation.camera_clocks import Clock
    from trecsim.lab.simulation.people import ScriptedPeople
    from trecsim.lab.simulation.roles import Role
    from trecsim.lab.simulation.room import corner_rig
    from trecsim.lab.simulation.scene import Scene

    rng = np.random.default_rng([seed, 31])
    passing, messages = at_the_gate(rng)
    visits = [*passing, *off_the_chairs(rng), *at_the_bed(rng)]
    roles: tuple[Role, ...] = tuple(Role((visit,)) for visit in visits)
    clocks = tuple(Clock(FPS, start_s=(0.37 * n % 1.0) / FPS) for n in range(cameras))
    alive = [{"t_s": float(t_s)} for t_s in range(0, int(SECONDS), 5)]
    lines = sorted([*messages, *alive], key=lambda one: float(one["t_s"]))
    scene = Scene(corner_rig(*ROOM_M, cameras), ScriptedPeople(roles), SECONDS, clocks=clocks)
    return GateRoom(scene, "".join(f"{json.dumps(one)}\n" for one in lines))
