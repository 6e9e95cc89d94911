"""How well people are followed who do other things than walk, on recorded motion.

Clips of real motion (data beside the repository) are played by made bodies in a room with four and
with two cameras, while somebody else walks past; what has no clip, falling, rolling and crawling,
is made. A get-up backwards at 2.5 times its speed is there as well, though faster than nature.
The detector has the errors of a real one; seeds 1000 and up, which nothing was tuned on. Errors are
set against those of recorded walking at the same place in the same room.

Run: ``python benchmarks/movement.py``
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from harness import scoring
from harness.command import alone
from harness.figures import Figures, over_seeds, summed
from harness.following import Flags, Followed, errors, followed
from harness.options import Options, fingerprint, shared_data

if TYPE_CHECKING:
    from trecsim.lab.simulation import Simulation
    from trecsim.lab.simulation.actions import Action
    from trecsim.lab.simulation.camera_clocks import Clock
    from trecsim.lab.simulation.people import Person

SEEDS, QUICK_SEEDS = 10, 4
COMPOSED_SEEDS = 4  # there only the detector's errors differ
CAMERAS = (4, 2)
FPS = 25.0
ROOM_M = (6.0, 5.0, 2.5)  # width, depth, height of the cameras
HALL_M = (10.0, 8.0, 2.7)  # for the composed scenes, where people walk 10 m
INSIDE_M = (3.4, 2.6)  # what counts there: this far from the middle, along x and y
WALKING, RUNNING = "walking", "running"
SPED_UP = "a get-up backwards, sped up"
COMES_S = 0.4  # who comes in running has just been found so long after
ON_THE_FLOOR = ("lying down", "lying", "falling", "lying after it", "rolling", "getting up",
                "crawling")  # fmt: skip
Point = tuple[float, float]
Part = tuple[str, tuple["Action", ...]]
Act = Callable[["Clips", np.random.Generator], tuple[Part, ...]]
Task = tuple[str, int, int, Path, Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class Troupe:
    """People whose motions are known before."""

    members: "tuple[Person, ...]"

    @property
    def count(self) -> int:
        """Number of people."""
        return len(self.members)

    def __call__(self, seconds: float, rng: np.random.Generator) -> "tuple[Person, ...]":
        """Return everybody."""
        return self.members


class Clips:
    """The clips of a folder, as actions."""

    def __init__(self, folder: Path, seed: int) -> None:
        self._folder, self._seed = folder, seed

    def one_of(self, *names: str, **how: Any) -> "tuple[Action, ...]":
        """Return one of these clips; the next seed takes the next one."""
        from trecsim.lab.simulation.actions import Clip

        return (Clip(self._folder / f"{names[self._seed % len(names)]}.npz", **how),)


def anywhere(rng: np.random.Generator) -> Point:
    """Return a point about the middle of the room."""
    x_m, y_m = rng.uniform((-1.2, -0.9), (1.2, 0.9))
    return float(x_m), float(y_m)


def _lying(side: str, seconds: float) -> "Action":
    from trecsim.lab.simulation.actions import Lie

    return Lie(seconds, side)  # type: ignore[arg-type]


def _lying_down(clips: Clips, rng: np.random.Generator) -> "tuple[Part, ...]":
    lies_down = clips.one_of("dm_liedown_faceup_reversed")
    return ("lying down", lies_down), ("lying", (_lying("back", 2.0),))


def _up(clips: Clips, rng: np.random.Generator) -> "tuple[Part, ...]":
    before = _lying("back" if rng.random() < 0.5 else "left", 1.0)
    return ("", (before,)), ("getting up", clips.one_of("dm_getup_faceup"))


def _rolling(clips: Clips, rng: np.random.Generator) -> "tuple[Part, ...]":
    sides = ("left", "front", "right") if rng.random() < 0.5 else ("right", "front", "left")
    return (
        ("", (_lying("back", 0.5),)),
        ("rolling", tuple(_lying(side, 0.3) for side in (*sides, "back"))),
    )


def _crawling(clips: Clips, rng: np.random.Generator) -> "tuple[Part, ...]":
    from trecsim.lab.simulation.actions import Crawl

    return (("crawling", (Crawl((anywhere(rng),), float(rng.uniform(0.4, 0.7))),)),)


def _along(name: str, *clips_of: str, **how: Any) -> "Act":
    """Return an act in which a clip is bent to go about the middle of the room."""
    return lambda clips, rng: (
        (name, clips.one_of(*clips_of, along_m=tuple(anywhere(rng) for _ in range(8)), **how)),
    )


def _fall(clips: Clips, rng: np.random.Generator) -> "tuple[Part, ...]":
    from trecsim.lab.simulation.actions import Fall

    to = str(rng.choice(("back", "front", "left", "right")))
    falls = Fall(0.1, to)  # type: ignore[arg-type]
    return ("falling", (falls,)), ("lying after it", (_lying(to, 2.0),))


def _sped_up_fall(clips: Clips, rng: np.random.Generator) -> "tuple[Part, ...]":
    return ((SPED_UP, (*clips.one_of("dm_pseudofall_faceup"), _lying("back", 1.5))),)


def _through(clips: Clips, rng: np.random.Generator) -> "tuple[Part, ...]":
    """Return a run through the room, which begins and ends at full speed."""
    return ((RUNNING, clips.one_of("dm_jog", "dm_run", times=2, along_m=(_edge(rng, 2.0),))),)


def _edge(rng: np.random.Generator, x_m: float) -> Point:
    return x_m, float(rng.uniform(-0.6, 0.9))


def _in_place(name: str, *clips_of: str, **how: Any) -> "Act":
    return lambda clips, rng: ((name, clips.one_of(*clips_of, **how)),)


ACTS: "dict[str, Act]" = {
    WALKING: _along(
        WALKING, "bn1_walk_normal_001", "bn2_walk_normal_001", "dm_long_walk1", to_s=5.0
    ),
    "lying down": _lying_down,
    "falling": _fall,
    "getting up": _up,
    "rolling": _rolling,
    "crawling": _crawling,
    "jumping": _in_place("jumping", "dm_jump", times=2),
    "kicking": _in_place("kicking", "dm_spinkick", "bn1_kick_normal_001", "dm_kick", to_s=4.0),
    "dancing": _in_place("dancing", "dm_dance_a", "dm_dance_b", "bn1_dance-short_normal_001",
                         to_s=4.0),
    "spinning": _in_place("spinning", "dm_spin"),
    "striking": _in_place("striking", "dm_punch", "bn1_slash_normal_001", "bn1_punch_normal_002",
                          to_s=4.0),
    "bowing": _in_place("bowing", "bn1_bow_active_001", "bn1_bow_normal_001", to_s=4.0),
    "waving": _in_place("waving", "bn2_wave-both-hands_normal_001", "bn1_byebye_normal_001",
                        to_s=3.0),
    RUNNING: _through,
    SPED_UP: _sped_up_fall,
}  # fmt: skip
"""Everything that somebody does, in parts; those without a name do not count."""


def usual_clocks(cameras: int) -> "tuple[Clock, ...]":
    """Return clocks of cameras that are not synchronised."""
    from trecsim.lab.simulation.camera_clocks import Clock

    return tuple(Clock(FPS, start_s=(0.37 * n % 1.0) / FPS) for n in range(cameras))


def made(
    name: str, cameras: int, seed: int, folder: Path, clocks: "tuple[Clock, ...]" = ()
) -> "tuple[Simulation, dict[str, Any]]":
    """Return a scene in which somebody acts and somebody walks past, and when each part is."""
    from trecsim.lab.simulation.actions import Turn, Walk
    from trecsim.lab.simulation.body_shape import bodies
    from trecsim.lab.simulation.motion import motion_of
    from trecsim.lab.simulation.people import Person
    from trecsim.lab.simulation.room import corner_rig
    from trecsim.lab.simulation.scene import Scene, simulate

    rng = np.random.default_rng([seed, list(ACTS).index(name)])
    actor, passer = bodies(2, rng)
    spot_m = _edge(rng, -2.2) if name == RUNNING else anywhere(rng)
    from_rad, faces_rad = rng.uniform(-np.pi, np.pi, 2)
    start_m = (spot_m[0] + 1.2 * np.cos(from_rad), spot_m[1] + 1.2 * np.sin(from_rad))
    comes = Walk((spot_m,), 1.0), Turn(to_deg=float(np.degrees(faces_rad)))
    parts = [("", comes), *ACTS[name](Clips(folder, seed), rng)]
    if name == RUNNING:
        start_m, parts = spot_m, parts[1:]
    ends_s = [COMES_S if name == RUNNING else 0.0]
    so_far: list[Action] = []
    for _, actions in parts:
        so_far += actions
        ends_s.append(motion_of(actor, start_m, 0.0, so_far).leave_s)
    until_s = ends_s[-1] + (0.0 if name == RUNNING else 0.4)
    acts = motion_of(actor, start_m, 0.0, so_far, until_s=None if name == RUNNING else until_s)
    aside = float(rng.choice((-1.0, 1.0)) * 1.6)
    way_m = tuple((x_m, aside) for x_m in (2.2, -2.2) * 8)
    passes = motion_of(passer, (-2.2, aside), 0.0, (Walk(way_m, 1.1),), until_s=until_s)
    people = Troupe((Person(actor.stature_m, acts), Person(passer.stature_m, passes)))
    clocks = clocks or usual_clocks(cameras)
    scene = Scene(corner_rig(*ROOM_M, cameras), people, until_s, clocks=clocks)
    names = [part for part, _ in parts]
    return simulate(scene, seed), {
        part: span_s for part, span_s in zip(names, pairwise(ends_s), strict=True) if part
    }


def truth_of(made_: "Simulation") -> Any:
    """Return the truth of a scene."""
    from trecsim.store.truth import Truth

    return Truth(made_.truth_t_s, made_.truth_xyz_m)


def act(task: Task) -> tuple[dict[str, dict[str, float]], str]:
    """Return the errors of whoever acts, by part of the act, and the input's fingerprint."""
    name, cameras, seed, folder, overrides = task
    scene, spans_s = made(name, cameras, seed, folder)
    one = followed(scene.poses, scene.rig, truth_of(scene), overrides)
    found = {}
    for part, (from_s, until_s) in spans_s.items():
        then = (one.t_s > from_s) & (one.t_s <= until_s)
        found[part] = {
            **errors(one, of_first(one, then)),
            "lost": float(lost(one.identity[0], then)),
            "acceleration of the hips": acceleration_mps2(one, then),
        }
    return found, fingerprint(scene.poses)


def lost(identity: "np.ndarray", then: Flags) -> bool:
    """Return whether who was there before some moments bears another identity at their end."""
    begin, end = np.flatnonzero(then)[[0, -1]]
    known = identity[: begin + 1][identity[: begin + 1] >= 0]
    before = known[-1] if len(known) else identity[then].max()
    return bool(identity[end] != before)


def acceleration_mps2(one: Followed, then: Flags) -> float:
    """Return how fast the true motion of the first person changes, 95 % of the time."""
    hips_m = one.truth_m[0][:, [11, 12]].mean(axis=1)
    step_s = np.gradient(one.t_s)[:, None]
    change = np.gradient(np.gradient(hips_m, axis=0) / step_s, axis=0) / step_s
    return float(np.nanquantile(np.linalg.norm(change[then], axis=1), 0.95))


def of_first(one: Followed, then: Flags) -> Flags:
    """Return the joints of the first person at some moments."""
    part: Flags = np.zeros(one.support.shape, np.bool_)
    part[0] = then[:, None]
    return part


def composed(task: Task) -> tuple[dict[str, float], str]:
    """Return the errors of everybody in a scene composed of clips, and the input's fingerprint."""
    name, cameras, seed, folder, overrides = task
    scene = made_composed(name, cameras, seed, folder)
    one = followed(scene.poses, scene.rig, truth_of(scene), overrides)
    torso_m = one.truth_m[:, :, [5, 6, 11, 12], :2].mean(axis=2)
    with np.errstate(invalid="ignore"):
        inside = (np.abs(torso_m) <= INSIDE_M).all(axis=-1)
    part = np.repeat(inside[:, :, None], one.support.shape[2], axis=2)
    return errors(one, part), fingerprint(scene.poses)


def made_composed(
    name: str, cameras: int, seed: int, folder: Path, clocks: "tuple[Clock, ...]" = ()
) -> "Simulation":
    """Return a scene composed of clips."""
    from trecsim.lab.simulation.room import corner_rig
    from trecsim.lab.simulation.scene import Scene, simulate

    with np.load(folder / "scenes" / f"{name}.npz") as file:
        joints_m, fps = file["joints"][:, :, :17], float(file["fps"])
    people = Troupe(tuple(clip_person(person_m, fps) for person_m in joints_m))
    seconds = (joints_m.shape[1] - 1) / fps
    clocks = clocks or usual_clocks(cameras)
    return simulate(Scene(corner_rig(*HALL_M, cameras), people, seconds, clocks=clocks), seed)


def clip_person(xyz_m: np.ndarray, fps: float) -> "Person":
    """Return somebody who moves as in a clip, while there."""
    from trecsim.lab.simulation.people import Person
    from trecsim.lab.simulation.sampled import Sampled

    here = np.flatnonzero(np.isfinite(xyz_m[:, 0, 0]))
    enter_s, leave_s = here[0] / fps, here[-1] / fps
    motion = Sampled(enter_s, 1.0 / fps, xyz_m[here[0] : here[-1] + 1].astype(np.float32), leave_s)
    legs_m = np.linalg.norm(np.diff(xyz_m[here[0], [11, 13, 15]], axis=0), axis=1).sum()
    return Person(float(legs_m / 0.491), motion)  # the share that legs have of a stature


Runs = dict[str, dict[int, dict[str, float]]]


def acts_with(cameras: int, seeds: Sequence[int], folder: Path, options: Options) -> Runs:
    """Return the errors in every part of every act, by seed."""
    runs: Runs = {}
    for name in ACTS:
        tasks = [(name, cameras, seed, folder, options.overrides) for seed in seeds]
        here = f"{name}, {cameras} cameras"
        found = dict(zip(seeds, options.over(act, tasks, here), strict=True))
        options.fingerprints[here] = found[seeds[0]][1]
        for seed, (parts, _) in found.items():
            for part, values in parts.items():
                runs.setdefault(part, {})[seed] = values
    return runs


def figures_of(runs: Runs) -> Figures:
    """Return the figures of every act, each with its error relative to that of walking."""
    usual_cm = {seed: values["mean error"] for seed, values in runs[WALKING].items()}
    out: dict[str, dict[str, Figures]] = {"on the floor": {}, "other": {}}
    for name, by_seed in runs.items():
        relative = {seed: values["mean error"] / usual_cm[seed] for seed, values in by_seed.items()}
        group = "on the floor" if name in ON_THE_FLOOR else "other"
        hips = {seed: values["acceleration of the hips"] for seed, values in by_seed.items()}
        out[group][name] = {
            "error / walking": over_seeds(relative, "x"),
            **scoring.of_seeds(by_seed),
            "lost": summed({seed: values["lost"] for seed, values in by_seed.items()}),
            "acceleration of the hips": replace(over_seeds(hips, "m/s^2"), watched=False),
        }
    return out


def measure(options: Options) -> Figures:
    """Measure people who lie, fall, roll, crawl, get up, jump, kick and dance."""
    folder = shared_data("mocap")
    seeds = options.seeds(SEEDS, QUICK_SEEDS)
    options.input.update(data="mocap beside the repository", seeds=[seeds[0], seeds[-1]], fps=FPS)
    figures: dict[str, Figures] = {
        f"{cameras} cameras": figures_of(acts_with(cameras, seeds, folder, options))
        for cameras in CAMERAS
    }
    scenes = json.loads((folder / "scenes" / "index.json").read_text(encoding="utf-8"))
    several: dict[str, Figures] = {}
    for name in [one["scene"] for one in scenes]:
        for cameras in CAMERAS:
            some = seeds[:COMPOSED_SEEDS]
            tasks = [(name, cameras, seed, folder, options.overrides) for seed in some]
            here = f"{name}, {cameras} cameras"
            found = dict(zip(some, options.over(composed, tasks, here), strict=True))
            options.fingerprints[here] = found[seeds[0]][1]
            several[here] = scoring.of_seeds({seed: one for seed, (one, _) in found.items()})
    return {**figures, "several people": several}


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
