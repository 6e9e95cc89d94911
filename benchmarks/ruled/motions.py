"""What people do when they fall, and what they do that is no fall, each by name.

No real fall was recorded for this: falls are made by the simulator, and one is a recorded get-up
played backwards at 2.5 times its speed. `clip` stands for recorded motion of the data beside the
repository, `made` for the simulator's own.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from trecsim.lab.simulation.roles import Role
    from trecsim.lab.simulation.scene import Scene

ROOM_M = (8.0, 7.0, 2.8)  # width, depth, height of the cameras
SPOTS_M = ((-1.9, -1.2), (1.9, -1.2), (0.0, 1.6))
LONGEST_S = 14.0
AFTER_S = 6.0  # who falls lies there so long

SITE = """
format = "trecsim.site/1"
name = "motions"
[[rules]]
id = "fall"
kind = "body.fall"
"""
Make = Callable[[Path, np.random.Generator], tuple[Any, ...]]


def _fall(to: str) -> Make:
    def made(folder: Path, rng: np.random.Generator) -> tuple[Any, ...]:
        from trecsim.lab.simulation.actions import Fall

        return (Fall(AFTER_S, to, float(rng.uniform(0.65, 1.15))),)  # type: ignore[arg-type]

    return made


def _clip(name: str, then_lies: bool = False, **how: Any) -> Make:
    def made(folder: Path, rng: np.random.Generator) -> tuple[Any, ...]:
        from trecsim.lab.simulation.actions import Clip, Lie

        lies = (Lie(AFTER_S - 2.0, "back"),) if then_lies else ()
        return (Clip(folder / f"{name}.npz", **how), *lies)

    return made


def _made(action: str, **how: Any) -> Make:
    """Return an action of the simulator; of a pair of numbers one between them is drawn."""

    def made(folder: Path, rng: np.random.Generator) -> tuple[Any, ...]:
        from trecsim.lab.simulation import actions

        drawn = {
            key: float(rng.uniform(*value)) if isinstance(value, tuple) else value
            for key, value in how.items()
        }
        return (getattr(actions, action)(**drawn),)

    return made


def _crawls(folder: Path, rng: np.random.Generator) -> tuple[Any, ...]:
    from trecsim.lab.simulation.actions import Crawl

    return (Crawl(((0.2, 0.3), (-0.4, 0.0)), float(rng.uniform(0.4, 0.7))),)


FALLS: Mapping[str, Make] = {
    "falling backwards (made)": _fall("back"),
    "falling forwards (made)": _fall("front"),
    "falling to the left (made)": _fall("left"),
    "falling to the right (made)": _fall("right"),
    "get-up backwards at 2.5 times its speed (clip dm_pseudofall_faceup)":
        _clip("dm_pseudofall_faceup", then_lies=True),
}  # fmt: skip
NO_FALLS: Mapping[str, Make] = {
    "sitting down (made)": _made("Sit", seconds=4.0, seat_m=(0.38, 0.5)),
    "sitting down on a low seat (made)": _made("Sit", seconds=4.0, seat_m=(0.3, 0.35)),
    "lying down (made, back)": _made("Lie", seconds=4.0, on="back"),
    "lying down (made, left)": _made("Lie", seconds=4.0, on="left"),
    "lying down (made, front)": _made("Lie", seconds=4.0, on="front"),
    "lying down (clip dm_liedown_faceup_reversed)":
        _clip("dm_liedown_faceup_reversed", then_lies=True),
    "bending (made)": _made("Bend", seconds=(1.0, 4.0), angle_deg=(60.0, 105.0)),
    "bowing (clip bn1_bow_active_001)": _clip("bn1_bow_active_001", to_s=4.0),
    "crouching (made)": _made("Crouch", seconds=(1.0, 4.0)),
    "tying shoes (made: kneeling, far forward)": _made("Kneel", seconds=4.0, lean_deg=(45.0, 65.0)),
    "kneeling (made)": _made("Kneel", seconds=4.0, lean_deg=(10.0, 25.0)),
    "picking up (made: bending, short)": _made("Bend", seconds=0.2, angle_deg=(80.0, 105.0)),
    "picking up (made: crouching, short)": _made("Crouch", seconds=0.2),
    "crawling (made)": _crawls,
    "dancing (clip dm_dance_a)": _clip("dm_dance_a", to_s=8.0),
    "dancing (clip dm_dance_b)": _clip("dm_dance_b", to_s=8.0),
    "dancing (clip bn1_dance-short_normal_001)": _clip("bn1_dance-short_normal_001", to_s=6.0),
    "jumping (clip dm_jump)": _clip("dm_jump", times=2),
    "kicking (clip dm_spinkick)": _clip("dm_spinkick"),
    "getting up (clip dm_getup_faceup)": _clip("dm_getup_faceup"),
}  # fmt: skip
EVERYTHING: Mapping[str, Make] = {**FALLS, **NO_FALLS}


def acted(names: tuple[str, ...], seed: int, folder: Path) -> "tuple[tuple[Role, ...], float]":
    """Return up to three people who each do one thing, and how long that takes [s]."""
    from trecsim.lab.simulation.actions import Stand, Turn
    from trecsim.lab.simulation.body_shape import body
    from trecsim.lab.simulation.roles import Role, Visit

    rng = np.random.default_rng([seed, 77, *(list(EVERYTHING).index(name) for name in names)])
    roles, seconds = [], 0.0
    for name, (x_m, y_m) in zip(names, SPOTS_M, strict=False):
        at_m = (x_m + float(rng.uniform(-0.2, 0.2)), y_m + float(rng.uniform(-0.2, 0.2)))
        actions: list[Any] = [Stand(1.5), Turn(to_deg=float(rng.uniform(-180.0, 180.0)))]
        actions += [_placed(one, at_m) for one in EVERYTHING[name](folder, rng)]
        stature_m = round(float(rng.uniform(1.55, 1.95)), 2)
        visit = Visit(at_m, tuple(actions), 0.0)
        motion = visit.motion(body(stature_m), 60.0, 0.0)
        seconds = max(seconds, min(_still_from_s(motion), LONGEST_S))
        roles.append(Role((visit,), stature_m))
    return tuple(roles), seconds


def _placed(action: Any, at_m: tuple[float, float]) -> Any:
    """Return an action with its way points counted from a place."""
    from dataclasses import replace

    points_m = getattr(action, "to_m", None)
    if points_m is None or isinstance(points_m, float):
        return action
    return replace(action, to_m=tuple((x + at_m[0], y + at_m[1]) for x, y in points_m))


def _still_from_s(motion: Any) -> float:
    """Return from when on somebody only stands or lies, and a little more [s]."""
    t_s = np.arange(0.0, 40.0, 0.1)
    xyz_m = motion(t_s)
    moves = np.linalg.norm(np.diff(xyz_m[:, [11, 5]], axis=0), axis=2).max(axis=1) > 0.008
    last = np.flatnonzero(moves)
    return float(t_s[last[-1]]) + 2.5 if len(last) else 3.0


def scene(names: tuple[str, ...], seed: int, folder: Path, cameras: int, fps: float) -> "Scene":
    """Return a room in which people do these things, each at their own spot."""
    from trecsim.lab.simulation.camera_clocks import Clock
    from trecsim.lab.simulation.people import ScriptedPeople
    from trecsim.lab.simulation.room import corner_rig
    from trecsim.lab.simulation.scene import Scene

    roles, seconds = acted(names, seed, folder)
    clocks = tuple(Clock(fps, start_s=(0.37 * n % 1.0) / fps) for n in range(cameras))
    return Scene(corner_rig(*ROOM_M, cameras), ScriptedPeople(roles), seconds, clocks=clocks)
