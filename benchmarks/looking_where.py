"""Which camera is looked at next: by the tracker's people, beside each in turn; and a crowd.

- *Turns*: the built-in scene ``two-rooms`` (six cameras, 25 images a second; one of the rooms is
  empty most of the time). The estimator processes a limited number of images a second, one after
  the other. *In turn*: always the camera that has waited longest. *Where people move*: by the
  tracker's snapshot, a camera with people in view weighs twice as much as one without, and up to
  four times as much if limbs move fast or a track is coasting; a camera that has waited for 0.4 s
  goes first, because somebody may have entered. That policy is not part of the product: see
  ``docs/decisions/looking.md``.
- *Crowd*: 30 people before 12 cameras of 24 images a second. *Together* is
  `trecsim.looking.schedule.Together` at every third moment, a fifth of the work; light looks lose
  people by their size as images of three quarters of the size would, and their key points are a
  tenth less exact. *Even* is the usual look at every fourth.
- *Policy*: the processor time of planning the looks of a moment, and of noting what they found,
  for 12 cameras and 30 people in each image.

Run: ``python benchmarks/looking_where.py [--quick]``; ``--quick`` takes one seed of each.
"""

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from harness.command import alone
from harness.figures import Figures, once
from harness.options import Options
from harness.scoring import of_seeds, scores
from trecsim.estimators.looks import Look
from trecsim.fusion import Tracker
from trecsim.geometry import Rig
from trecsim.lab.simulation import read_scene, room_scene, simulate
from trecsim.lab.simulation.scene import Clock
from trecsim.looking import Attention, ByNeed, Outlook, Together, cost, lighter, noted
from trecsim.looking.look_policy import NEWCOMER_S
from trecsim.store.truth import Truth
from trecsim.values import COASTING, FrameSet, Poses2D, Snapshot

if TYPE_CHECKING:
    from trecsim.lab.simulation import Simulation

NextCamera = Callable[[Mapping[str, float], Snapshot | None], str]
"""Chooses among cameras by how long each has waited [s], and where everybody is."""

LOOKS_PER_S = (20.0, 40.0)
LAGS_S = {"newest": 0.0, "lag 0.2 s": 0.2}
CROWD_FPS, CROWD_S, SIZE_PX = 24.0, 10.0, (1920, 1080)
LIGHT_PX, LIGHT_SIGMA = 4 / 3, 1.1
STILL, FAST, FASTEST_MPS, MARGIN_SHARE = 2.0, 4.0, 2.0, 0.15
SCORES = ("mean error", "p95 error", "missed", "switches", "IDF1", "found after, median")


def measure(options: Options) -> Figures:
    """Measure what the choice of the next camera is worth, and a fifth of the looks at a crowd."""
    options.input.update(data="built-in scene two-rooms; a hall of 30 people", seeds_from=1000)
    seeds = list(options.seeds(4, 1))
    turns = {seed: simulate(read_scene("two-rooms"), seed) for seed in seeds}
    crowds = {seed: crowd(seed) for seed in seeds[:2]}
    out: dict[str, dict[str, Figures]] = {}
    for lag, lag_s in LAGS_S.items():
        for per_s in LOOKS_PER_S:
            for name, policy in (("in turn", longest), ("where people move", moving)):
                found = {
                    seed: scored(made, looked(made, policy(made.rig), per_s), lag_s)
                    for seed, made in turns.items()
                }
                out.setdefault(f"turns, {per_s:g} looks a second", {}).setdefault(lag, {})[name] = (
                    of_seeds(found)
                )
        full = {seed: scored(made, made.poses, lag_s) for seed, made in turns.items()}
        out.setdefault("turns, every image", {})[lag] = {"": of_seeds(full)}
        options.tell(f"turns, {lag}")
        out.setdefault("crowd", {})[lag] = of_crowd(crowds, lag_s)
        options.tell(f"crowd, {lag}")
    out["policy"] = {"cost": {"ms a moment": once(cost_ms(), "ms", matters=0.2)}}
    return out


def longest(rig: Rig) -> NextCamera:
    """Return the policy that takes the camera that has waited longest."""
    return lambda waited_s, people: max(waited_s, key=lambda camera: waited_s[camera])


def moving(rig: Rig) -> NextCamera:
    """Return the policy that looks where people move."""

    def next_camera(waited_s: Mapping[str, float], people: Snapshot | None) -> str:
        late = [camera for camera, waited in waited_s.items() if waited >= NEWCOMER_S]
        if late or people is None:
            return max(late or waited_s, key=lambda camera: waited_s[camera])
        weight = dict(zip(rig.names, weights(rig, people).tolist(), strict=True))
        return max(waited_s, key=lambda camera: waited_s[camera] * weight[camera])

    return next_camera


def weights(rig: Rig, people: Snapshot) -> np.ndarray:
    """Return how much each camera's images tell, by who is in view; 1 where nobody is."""
    if not len(people.id):
        return np.ones(len(rig))
    speed_mps = np.linalg.norm(np.nan_to_num(people.velocity_mps), axis=-1).max(axis=1)
    share = np.where(people.state == COASTING, 1.0, np.minimum(speed_mps / FASTEST_MPS, 1.0))
    need = STILL + (FAST - STILL) * share
    return np.where(in_view(rig, people), need, 1.0).max(axis=1)


def in_view(rig: Rig, people: Snapshot) -> np.ndarray:
    """Return whether the middle of a person lies in an image or just outside (cam, person)."""
    middle_m = people.xyz_m.mean(axis=1)
    xyw = np.einsum("cij,pj->cpi", rig.P[:, :, :3], middle_m) + rig.P[:, None, :, 3]
    depth = np.maximum(xyw[..., 2:], 0.1)
    share = xyw[..., :2] / depth / np.array([camera.size_px for camera in rig])[:, None]
    inside = (share > -MARGIN_SHARE) & (share < 1.0 + MARGIN_SHARE)
    return inside.all(axis=-1) & (xyw[..., 2] > 0.1)


def looked(made: "Simulation", policy: NextCamera, per_s: float) -> list[Poses2D]:
    """Return the images that an estimator of limited rate is given, in a closed loop."""
    tracker, people = Tracker(made.rig, provisional=True), None
    newest: dict[str, Poses2D] = {}
    looked_s = dict.fromkeys(made.rig.names, -1.0)
    taken, free_s = [], 0.0
    for image in made.poses:
        newest[image.camera] = image
        if image.t_s < free_s or not newest:
            continue
        waited_s = {name: image.t_s - looked_s[name] for name in newest}
        name = policy(waited_s, people)
        looked_s[name], free_s = image.t_s, max(free_s, image.t_s - 1.0 / per_s) + 1.0 / per_s
        one = newest.pop(name)
        taken.append(one)
        people = tracker.step(FrameSet(one.t_s, (one,)))
    return sorted(taken, key=lambda one: one.t_s)


def scored(made: "Simulation", poses: Iterable[Poses2D], lag_s: float) -> dict[str, float]:
    """Return the scores of some images of a scene."""
    found = scores(poses, made.rig, Truth(made.truth_t_s, made.truth_xyz_m), lag_s, {})
    return {name: found[name] for name in SCORES}


def crowd(seed: int) -> "tuple[Simulation, Simulation]":
    """Return a crowd as the usual look shows it, and as a light one does."""
    scene = room_scene(
        people=30, cameras=12, seconds=CROWD_S, width_m=18.0, depth_m=14.0, height_m=4.0
    )
    scene = replace(scene, clocks=(Clock(CROWD_FPS),))
    usual = scene.detector
    light = replace(
        usual,
        small_px=LIGHT_PX * usual.small_px,
        sigma=tuple(LIGHT_SIGMA * sigma for sigma in usual.sigma),
    )
    return simulate(scene, seed), simulate(replace(scene, detector=light), seed)


def of_crowd(
    crowds: "dict[int, tuple[Simulation, Simulation]]", lag_s: float
) -> dict[str, Figures]:
    """Return the scores of ways of looking at a crowd, and their cost."""
    ways: dict[str, Callable[[int, int], int]] = {
        "full": lambda frame, place: 512,
        "even, every 4th": lambda frame, place: 512 * (frame % 4 == 0),
        "together, every 3rd": lambda frame, place: (
            (512, 384)[(frame // 3 + place) % 2] * (frame % 3 == 0)
        ),
    }
    out: dict[str, Figures] = {}
    usual: dict[int, dict[str, float]] = {}
    for name, way in ways.items():
        found: dict[int, dict[str, float]] = {}
        shares = []
        for seed, both in crowds.items():
            poses, share = chosen(both, way)
            found[seed] = scored(both[0], poses, lag_s)
            shares.append(share)
        usual = usual or found
        ratio = np.mean([found[s]["mean error"] / usual[s]["mean error"] for s in crowds])
        out[name] = {
            **of_seeds(found),
            "mean error / full": once(float(ratio), "x", matters=0.02),
            "looks / full": once(float(np.mean(shares)), "", watched=False),
        }
    return out


def chosen(
    both: "tuple[Simulation, Simulation]", way: Callable[[int, int], int]
) -> tuple[list[Poses2D], float]:
    """Return the images that are looked at, and the share of the work."""
    fine, light = both
    names = fine.rig.names
    spent, out = 0.0, []
    for one, other in zip(fine.poses, light.poses, strict=True):
        side = way(round(one.t_s * CROWD_FPS), names.index(one.camera))
        if side:
            spent += cost([Look(side)], SIZE_PX)
            out.append(one if side == 512 else other)
    return out, spent / (len(fine.poses) * cost([Look(512), Look(256)], SIZE_PX))


def cost_ms(rounds: int = 500) -> float:
    """Return the least processor time of the looks of a moment of 12 cameras, planned and noted."""
    rng = np.random.default_rng(0)
    names = [f"camera {number}" for number in range(12)]
    usual = ByNeed(Look(512), Look(256), 384)
    schedule = Together(usual, lighter(usual))
    size_px = dict.fromkeys(names, SIZE_PX)
    xy_px = rng.uniform(100, 900, (30, 1, 2)) + rng.normal(0, 40, (30, 17, 2))
    poses = [Poses2D(name, 0.1, xy_px, np.ones((30, 17)), np.ones(30)) for name in names]
    seen = {
        name: noted(Attention(), [Look(512)], image, SIZE_PX)
        for name, image in zip(names, poses, strict=True)
    }
    least_s = np.inf
    for number in range(rounds):
        began_s = time.thread_time()
        planned = schedule(Outlook(0.2, number, size_px, seen))
        for image in poses:
            noted(seen[image.camera], planned[image.camera], image, SIZE_PX)
        least_s = min(least_s, time.thread_time() - began_s)
    return 1e3 * float(least_s)


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
