"""How well two cameras follow somebody who is close to one of them, and one camera alone.

*Close entry*: people appear 1.5 m from one of two cameras, so that their legs, and in places their
hips, are outside its image. *One camera*: two cameras know somebody whom one of them then does not
see for five seconds. The detector has the errors of a real one; seeds 1000 and up, which nothing
was tuned on.

Run: ``python benchmarks/close.py``; with other seeds and settings:
``python benchmarks/close.py --seeds 100 101 102 --set knot_s=0.2``
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from harness import scoring
from harness.command import alone
from harness.figures import Figure, Figures, once, over_seeds, summed
from harness.following import Array, Followed, errors, followed
from harness.options import Options, fingerprint, settings_from

if TYPE_CHECKING:
    from trecsim.geometry import Camera, Rig
    from trecsim.lab.simulation import Simulation
    from trecsim.lab.simulation.actions import Action
    from trecsim.lab.simulation.roles import Role
    from trecsim.values import Poses2D, Snapshot

SEEDS, QUICK_SEEDS = 24, 8
FPS = 25.0
Point = tuple[float, float]
Task = tuple[str, int, Mapping[str, Any]]

# Close entry.
CLOSE_M = 1.5
ASIDE_RAD = np.radians(22.0)  # people appear so far to the left or right of where a camera looks
ENTERS_S = (0.4, 1.6)  # when the two people appear, one before each camera
ENTRY_S = 7.4  # length of a scene
SINCE_S = (0.0, 0.5, 1.0, 2.0, 4.0, 6.0)
SEEN = {2: "in both images", 1: "in one image", 0: "in no image"}

# One camera.
KNOWN_S, ALONE_S, AGAIN_S = 4.0, 5.0, 1.0
AFTER_S = (1.0, 2.0, 5.0)
ABOUT_S = 0.2  # what counts as after a second is the mean over so long before
DOING = ("walking", "standing", "sitting", "lying")
TORSO = (5, 6, 11, 12)


@dataclass(frozen=True, slots=True)
class Room:
    """Two cameras, and the floor that both see."""

    rig: "Rig"
    from_m: Point
    to_m: Point

    def anywhere(self, rng: np.random.Generator) -> Point:
        """Return a point of that floor."""
        x_m, y_m = rng.uniform(self.from_m, self.to_m)
        return float(x_m), float(y_m)


def rooms() -> dict[str, Room]:
    """Return the rooms of close entry: cameras in two corners, and beside each other."""
    from trecsim.geometry import Rig
    from trecsim.lab.simulation.camera_placement import Make, look_at
    from trecsim.lab.simulation.room import corner_rig

    lens = Make(view_deg=92.0, lens="brown")
    places = (((0.0, 0.0, 2.3), (0.0, 3.0, 1.0)), ((-2.66, 0.57, 2.3), (-1.06, 2.94, 1.0)))
    beside = Rig(
        tuple(
            lens.camera(f"cam{n}", look_at(np.array(position_m), np.array(target_m)))
            for n, (position_m, target_m) in enumerate(places, start=1)
        )
    )
    return {
        "cameras in two corners": Room(corner_rig(7.0, 5.5, 2.3, 2), (-2.0, -0.6), (2.0, 1.6)),
        "cameras side by side": Room(beside, (-1.8, 2.6), (0.6, 3.8)),
    }


def entering(room: Room, seed: int) -> "Iterator[Role]":
    """Yield who appears before each camera: some go on, some stay, some pass before it."""
    from trecsim.lab.simulation.actions import Stand, Walk
    from trecsim.lab.simulation.roles import Role, Visit

    rng = np.random.default_rng(seed)
    for number, (camera, enter_s) in enumerate(zip(room.rig, ENTERS_S, strict=True)):
        aside = rng.uniform(-1.0, 1.0)
        inside = tuple(room.anywhere(rng) for _ in range(3))
        speed_mps = float(rng.uniform(0.7, 1.3))
        actions: tuple[Action, ...] = (Walk(inside, speed_mps),)
        kind = (seed + number) % 3
        if kind == 1:
            actions = (Stand(float(rng.uniform(0.5, 2.0))), *actions)
        elif kind == 2:
            aside = float(np.sign(aside))
            way = tuple(before(camera, aside * share) for share in (0.3, -0.3, -1.0))
            actions = (Walk(way, 0.8 * speed_mps), *actions)
        yield Role((Visit(before(camera, aside), actions, enter_s=enter_s),))


def before(camera: "Camera", aside: float) -> Point:
    """Return the point on the floor close to a camera, so far aside of where it looks (-1 to 1)."""
    ahead = camera.T_cam_world[2, :2]
    angle = np.arctan2(ahead[1], ahead[0]) + aside * ASIDE_RAD
    x_m, y_m = camera.position_m[:2] + CLOSE_M * np.array([np.cos(angle), np.sin(angle)])
    return float(x_m), float(y_m)


def made_entry(name: str, seed: int) -> "Simulation":
    """Return a scene of close entry."""
    from trecsim.lab.simulation.people import ScriptedPeople
    from trecsim.lab.simulation.scene import Scene, simulate

    room = rooms()[name]
    people = ScriptedPeople(tuple(entering(room, seed)))
    return simulate(Scene(room.rig, people, ENTRY_S, clocks=clocks()), seed)


def clocks() -> tuple[Any, ...]:
    """Return the clocks of two cameras, which run freely."""
    from trecsim.lab.simulation.camera_clocks import Clock

    return Clock(FPS), Clock(FPS, start_s=0.37 / FPS)


def entry(task: Task) -> tuple[dict[str, dict[str, float]], str]:
    """Return the errors of one scene of close entry by part, and the input's fingerprint."""
    name, seed, overrides = task
    made = made_entry(name, seed)
    one = followed(made.poses, made.rig, truth_of(made), overrides)
    since_s, seen = since_entry_s(one), images_with(one.truth_m, made.rig)
    parts = {"": np.ones(seen.shape, np.bool_)}
    for early_s, late_s in pairwise(SINCE_S):
        then = (since_s >= early_s) & (since_s < late_s)
        parts[f"{early_s:g} to {late_s:g} s"] = np.repeat(then[:, :, None], seen.shape[2], axis=2)
    parts |= {text: seen == count for count, text in SEEN.items()}
    return {part: errors(one, flags) for part, flags in parts.items()}, fingerprint(made.poses)


def truth_of(made: "Simulation") -> Any:
    """Return the truth of a scene."""
    from trecsim.store.truth import Truth

    return Truth(made.truth_t_s, made.truth_xyz_m)


def since_entry_s(one: Followed) -> Array:
    """Return for how long everybody has been there, (person, moment) [s]."""
    first = one.t_s[one.there.argmax(axis=1)]
    since_s: Array = one.t_s[None] - first[:, None]
    return since_s


def images_with(xyz_m: Array, rig: "Rig") -> npt.NDArray[np.int64]:
    """Return in how many images each joint is, hidden or not."""
    count = np.zeros(xyz_m.shape[:-1], np.int64)
    for camera in rig:
        xy_px = camera.project(xyz_m)
        with np.errstate(invalid="ignore"):
            count += ((xy_px >= 0) & (xy_px < camera.size_px)).all(axis=-1)
    return count


def doing(what: str, room: Room, rng: np.random.Generator) -> "Role":
    """Return somebody who walks, stands, sits or lies, and has done so when two cameras know."""
    from trecsim.lab.simulation.actions import Lie, Sit, Stand, Turn, Walk
    from trecsim.lab.simulation.roles import Role, Visit

    start_m, facing_rad = room.anywhere(rng), float(rng.uniform(-np.pi, np.pi))
    walk = Walk(tuple(room.anywhere(rng) for _ in range(12)), float(rng.uniform(0.7, 1.3)))
    actions: dict[str, tuple[Action, ...]] = {
        "walking": (walk,),
        "standing": (Stand(4.5), Turn(by_deg=68.75), Stand(60.0)),
        "sitting": (Stand(0.3), Sit(60.0)),
        "lying": (Lie(60.0, "back" if rng.random() < 0.5 else "left"),),
    }
    return Role((Visit(start_m, actions[what], facing_rad),))


def made_alone(what: str, seed: int) -> "tuple[Simulation, tuple[Poses2D, ...], Camera]":
    """Return a scene, what two cameras tell of it, and the one that always sees the person."""
    from trecsim.lab.simulation.people import ScriptedPeople
    from trecsim.lab.simulation.room import corner_rig
    from trecsim.lab.simulation.scene import Scene, simulate

    room = Room(corner_rig(7.0, 5.5, 2.5, 2), (-1.5, -0.3), (1.5, 1.7))
    people = ScriptedPeople((doing(what, room, np.random.default_rng([seed, DOING.index(what)])),))
    seconds = KNOWN_S + ALONE_S + AGAIN_S
    made = simulate(Scene(room.rig, people, seconds, clocks=clocks()), seed)
    eye = room.rig.cameras[seed % 2]
    poses = tuple(
        emptied(image) if image.camera != eye.name and hidden(image.t_s) else image
        for image in made.poses
    )
    return made, poses, eye


def hidden(t_s: float) -> bool:
    """Return whether one of the cameras does not see the person then."""
    return KNOWN_S <= t_s < KNOWN_S + ALONE_S


def emptied(image: "Poses2D") -> "Poses2D":
    """Return an image in which nobody is found."""
    from trecsim.values import Poses2D

    nobody = image.xy_px[:0], image.score[:0], image.person_score[:0]
    return Poses2D(image.camera, image.t_s, *nobody)


def one_camera(task: Task) -> tuple[dict[str, float], str]:
    """Return what became of somebody whom one camera sees alone, and the input's fingerprint.

    Depths are along the line of sight of that camera, positive where the person is taken to be too
    far away; they are NaN where nobody is followed any more.
    """
    from trecsim.lab.evaluation.truth_matching import truth_at
    from trecsim.tracking import follow

    what, seed, overrides = task
    made, poses, eye = made_alone(what, seed)
    truth, t_s, found = truth_of(made), [], []
    for snapshot in follow(poses, made.rig, settings_from(overrides)):
        truth_m = truth_at(np.array([snapshot.t_s]), truth)[0, 0]
        if np.isfinite(truth_m).all():
            t_s.append(snapshot.t_s)
            found.append(nearest(snapshot, truth_m, eye))
    depth_m, error_m, who = np.array(found).T
    return of_one_camera(np.array(t_s), depth_m, error_m, who), fingerprint(poses)


def nearest(snapshot: "Snapshot", truth_m: Array, eye: "Camera") -> tuple[float, float, int]:
    """Return how far the one nearest to somebody is off in depth and in all [m], and who it is."""
    if not len(snapshot.id):
        return np.nan, np.nan, -1
    off_m = np.linalg.norm(snapshot.xyz_m - truth_m, axis=-1).mean(axis=1)
    best = int(off_m.argmin())
    torso = list(TORSO)
    sight = truth_m[torso].mean(axis=0) - eye.position_m
    sight /= np.linalg.norm(sight)
    deeper_m = float((snapshot.xyz_m[best] - truth_m)[torso].mean(axis=0) @ sight)
    return deeper_m, float(off_m[best]), int(snapshot.id[best])


def of_one_camera(t_s: Array, depth_m: Array, error_m: Array, who: Array) -> dict[str, float]:
    """Return figures of one stretch with one camera, by name [cm]."""
    out: dict[str, float] = {}
    for after_s in (0.0, *AFTER_S):
        then = (t_s > KNOWN_S + after_s - ABOUT_S) & (t_s <= KNOWN_S + after_s)
        gone = bool((who[then] < 0).any())
        out[f"depth after {after_s:g} s"] = np.nan if gone else 100 * float(depth_m[then].mean())
        out[f"error after {after_s:g} s"] = np.nan if gone else 100 * float(error_m[then].mean())
    meanwhile = (t_s >= KNOWN_S) & (t_s < KNOWN_S + ALONE_S)
    later = who[(t_s >= KNOWN_S - ABOUT_S) & (who >= 0)]
    out["lost"] = 100 * float((who[meanwhile] < 0).mean())
    out["another identity"] = float((np.diff(later) != 0).sum())
    return out


ENTRY_KINDS = ("mean error", "p95 error", "joints within 15 cm", "missed", "switches")
Runs = Mapping[int, Mapping[str, float]]


def entry_figures(runs: Mapping[str, Mapping[int, Mapping[str, Mapping[str, float]]]]) -> Figures:
    """Return the figures of close entry: by room, time since entry, and images a joint is in."""
    by_room = {
        name: scoring.of_seeds({seed: found[""] for seed, found in by_seed.items()})
        for name, by_seed in runs.items()
    }
    parts = [part for part in next(iter(next(iter(runs.values())).values())) if part]
    by_part = {}
    for part in parts:
        both = {
            seed: {kind: mean_of([runs[name][seed][part][kind] for name in runs])
                   for kind in ENTRY_KINDS[:3]}
            for seed in next(iter(runs.values()))
        }  # fmt: skip
        by_part[part] = scoring.of_seeds(both)
    since = {part: by_part[part] for part in parts if part not in SEEN.values()}
    seen = {part: by_part[part] for part in parts if part in SEEN.values()}
    return {"rooms": by_room, "since entry": since, "joint": seen}


def mean_of(values: Sequence[float]) -> float:
    """Return the mean of the finite ones, NaN of none."""
    finite = [value for value in values if np.isfinite(value)]
    return float(np.mean(finite)) if finite else float("nan")


def alone_figures(runs: Mapping[int, Mapping[str, float]]) -> Figures:
    """Return the figures of one activity before one camera."""
    figures: dict[str, Figure] = {}
    for after_s in (0.0, *AFTER_S):
        depth_cm = {s: abs(found[f"depth after {after_s:g} s"]) for s, found in runs.items()}
        known = [value for value in depth_cm.values() if np.isfinite(value)] or [np.nan]
        name = f"depth off after {after_s:g} s"
        figures[name] = over_seeds(depth_cm, "cm")
        for text, quantile in (("p50", 0.5), ("p95", 0.95)):
            figures[f"{name}, {text}"] = once(
                float(np.quantile(known, quantile)), "cm", watched=False
            )
    last = {s: found[f"error after {AFTER_S[-1]:g} s"] for s, found in runs.items()}
    figures[f"joint error after {AFTER_S[-1]:g} s"] = over_seeds(last, "cm")
    figures["lost"] = over_seeds({s: found["lost"] for s, found in runs.items()}, "%", matters=0.5)
    figures["switches"] = summed({s: found["another identity"] for s, found in runs.items()})
    return figures


def measure(options: Options) -> Figures:
    """Measure people close to one of two cameras, and people whom one camera sees alone."""
    seeds = options.seeds(SEEDS, QUICK_SEEDS)
    options.input.update(data="simulated rooms", seeds=[seeds[0], seeds[-1]], fps=FPS)
    runs: dict[str, dict[int, dict[str, dict[str, float]]]] = {}
    for name in rooms():
        tasks = [(name, seed, options.overrides) for seed in seeds]
        found = dict(zip(seeds, options.over(entry, tasks, name), strict=True))
        options.fingerprints[name] = found[seeds[0]][1]
        runs[name] = {seed: one for seed, (one, _) in found.items()}
    alone_runs: dict[str, Figures] = {}
    for what in DOING:
        tasks = [(what, seed, options.overrides) for seed in seeds]
        known = dict(zip(seeds, options.over(one_camera, tasks, what), strict=True))
        options.fingerprints[what] = known[seeds[0]][1]
        alone_runs[what] = alone_figures({seed: one for seed, (one, _) in known.items()})
    return {"close entry": entry_figures(runs), "one camera": alone_runs}


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
