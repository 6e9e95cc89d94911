"""How exactly cameras are calibrated from people who walk, and whether the verdict is true.

Simulated rooms of 8 m x 6 m with cameras in the corners and, of eight, along the walls; people
wander for 40 s. The detector has the errors of a real one, those that all cameras share included
(preset `clothed`); clocks are off by up to 5 s; who is who is unknown. Seeds 1000 and up, on which
nothing was tuned.

Rotation: angle of a camera to its true orientation, after the best common turn of all. Upright:
angle between the vertical found and the true one. Position: after the best common motion. Tracking:
the mean error of joints that are tracked with the cameras found, after the same motion, divided by
that with the true ones.

Run: ``python benchmarks/people_calibration.py``; some of it: ``--quick``
"""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from harness.command import alone
from harness.figures import Figure, Figures, once, over_seeds, summed
from harness.options import Options

if TYPE_CHECKING:
    from trecsim.calibrating.people.calibrate import PeopleCalibration
    from trecsim.geometry import Rig
    from trecsim.lab.simulation import Simulation
    from trecsim.values import Poses2D

Array = npt.NDArray[np.float64]

NINETY = 2.5  # standard deviations per axis within which nine in ten errors lie


@dataclass(frozen=True, slots=True)
class Case:
    """One kind of recording.

    Attributes
    ----------
    people, cameras, seconds
        Of the scene.
    seeds, quick
        How many seeds, and with ``--quick``.
    drift_ppm
        Clocks drift by up to this.
    view_bias_m
        Key points are off by this much, depending on the direction from which a body is seen [m].
    lens_off
        Whether the focal lengths given are off by 2 %, and the principal points by 10 px.
    knocked
        Whether a camera is knocked by 2 degrees in mid-recording.
    """

    people: int = 3
    cameras: int = 4
    seconds: float = 40.0
    seeds: int = 20
    quick: int = 0
    drift_ppm: float = 0.0
    view_bias_m: float = 0.0
    lens_off: bool = False
    knocked: bool = False


CASES = {
    "three walkers": Case(quick=2),
    "one walker": Case(people=1, quick=1),
    "two cameras": Case(cameras=2, quick=1),
    "eight cameras": Case(cameras=8),
    "bias by view": Case(view_bias_m=0.015),
    "two minutes": Case(seconds=120.0, drift_ppm=100.0),
    "five minutes": Case(seconds=300.0, drift_ppm=100.0, seeds=5),
    "lenses off": Case(lens_off=True),
    "a camera knocked": Case(knocked=True, quick=1),
}


def measure(options: Options) -> Figures:
    """Calibrate simulated cameras from people who walk; compare with the truth."""
    found: dict[str, Any] = {}
    options.input.update(cases={name: str(case) for name, case in CASES.items()})
    for name, case in CASES.items():
        seeds = options.seeds(case.seeds, case.quick)
        if not seeds:
            continue
        warm()
        runs = dict(zip(seeds, options.over(run, [(name, s) for s in seeds], name), strict=True))
        options.tell(name)
        found[name] = figures_of(case, runs)
    return found


def warm() -> None:
    """Compile, so that no run is charged for it."""
    run(("three walkers", -1))


Run = Mapping[str, Any]


def run(task: tuple[str, int]) -> Run:
    """Return what came of one recording."""
    name, seed = task
    case = CASES[name] if seed >= 0 else replace(CASES[name], seconds=12.0, people=1)
    made, cameras, clocks = recording(case, abs(seed))
    first, other = made.rig.cameras[0], made.rig.cameras[2 if len(made.rig) > 2 else 1]
    apart_m = float(np.linalg.norm(first.position_m - other.position_m))
    began = time.process_time()
    try:
        done = calibrated(made, cameras, (first.name, other.name, apart_m))
    except Exception as error:
        return {"failed": 1.0, "why": str(error)}
    used_s = time.process_time() - began
    found = compared(done, made, clocks)
    tracking = math.nan if case.knocked else tracking_ratio(done.rig, made, clocks)
    return {"failed": 0.0, "cpu_s": used_s, "tracking": tracking, **found}


def calibrated(
    made: "Simulation", cameras: "Rig", distance: tuple[str, str, float]
) -> "PeopleCalibration":
    """Return the rig from the people alone."""
    from trecsim.calibrating.people.calibrate import calibrate_people

    return calibrate_people(made.poses, cameras, distance=distance)


def recording(case: Case, seed: int) -> "tuple[Simulation, Rig, tuple[Any, ...]]":
    """Return a recording, the intrinsics that are given, and the true clocks."""
    from trecsim.geometry import Rig
    from trecsim.lab.simulation import room_scene, simulate
    from trecsim.lab.simulation.camera_clocks import Clock
    from trecsim.lab.simulation.detector_errors import CLOTHED
    from trecsim.lab.simulation.failures import Knock

    rng = np.random.default_rng([seed, 77])
    scene = room_scene(people=case.people, cameras=case.cameras, seconds=case.seconds)
    clocks = tuple(
        Clock(
            25.0,
            start_s=(0.37 * number % 1.0) / 25.0,
            drift_ppm=float(rng.uniform(-case.drift_ppm, case.drift_ppm)),
            stamp_error_s=float(rng.uniform(-5.0, 5.0)),
        )
        for number in range(case.cameras)
    )
    knocks = ()
    if case.knocked:
        turn_deg = rng.normal(size=3)
        turn_deg *= 2.0 / np.linalg.norm(turn_deg)
        at_s = float(rng.uniform(0.25, 0.75) * case.seconds)
        knocks = (Knock("cam2", at_s, turn_deg=tuple(map(float, turn_deg))),)
    made = simulate(replace(scene, clocks=clocks, detector=CLOTHED, knocks=knocks), seed)
    if case.view_bias_m:
        shifts = rng.normal(0.0, case.view_bias_m, (2, 2, 17))
        made = replace(made, poses=tuple(biased(one, shifts) for one in made.poses))
    cameras = []
    for camera in made.rig:
        K = camera.K.copy()
        if case.lens_off:
            K[[0, 1], [0, 1]] *= 1.0 + 0.02 * rng.choice((-1.0, 1.0))
            K[:2, 2] += 10.0 * rng.choice((-1.0, 1.0), 2)
        cameras.append(replace(camera, K=K, T_cam_world=np.eye(4)))
    return made, Rig(tuple(cameras)), clocks


def biased(image: "Poses2D", shifts_m: Array) -> "Poses2D":
    """Return an image in which key points are shifted by how the body is turned to the camera."""
    xy_px = image.xy_px.copy()
    for body in xy_px:
        high_px = float(np.nanmax(body[:, 1]) - np.nanmin(body[:, 1]))
        wide = float(body[5, 0] - body[6, 0]) / (0.23 * high_px) if high_px > 0 else np.nan
        facing = np.clip(wide, -1.0, 1.0)  # 1: seen from the front, -1: from behind
        if np.isfinite(facing):
            side = np.sqrt(1.0 - facing**2)
            body += (facing * shifts_m[0] + side * shifts_m[1]).T * high_px / 1.6
    return replace(image, xy_px=xy_px)


def compared(done: "PeopleCalibration", made: "Simulation", clocks: Sequence[Any]) -> Run:
    """Return how far a rig is from the true one."""
    names = done.rig.names
    found, true = list(done.rig), [made.rig[name] for name in names]
    R, Q = (np.array([camera.T_cam_world[:3, :3] for camera in ones]) for ones in (found, true))
    common = common_turn(R, Q)
    turn_deg = np.array([angle_deg(R[i] @ common @ Q[i].T) for i in range(len(R))])
    p, q = (np.array([camera.position_m for camera in ones]) for ones in (found, true))
    p, q = (p - p.mean(axis=0)) @ common, q - q.mean(axis=0)
    scale = float((p * q).sum() / (p * p).sum())
    off_m = np.linalg.norm(p - q, axis=1)
    sd_deg = np.array([c.rotation_sd_deg for c in done.result.cameras if c.name in names])
    sd_m = np.array([c.position_sd_m for c in done.result.cameras if c.name in names])
    own = {camera.name: clock for camera, clock in zip(made.rig, clocks, strict=True)}
    late, drift = clock_errors(found, [own[name] for name in names])
    precision, recall = association(done, made, clocks)
    return {
        "rotation_deg": turn_deg,
        "upright_deg": float(np.degrees(np.arccos(min(1.0, common[2, 2])))),
        "position_m": off_m,
        "scale": abs(1.0 / scale - 1.0),
        "late_s": late,
        "drift_ppm": drift,
        "held_turn": float((turn_deg <= NINETY * sd_deg).mean()),
        "held_place": float((off_m <= NINETY * sd_m).mean()),
        "lost": float(len(made.rig) - len(names)),
        "verdict": done.result.verdict,
        "reasons": done.result.reasons,
        "precision": precision,
        "recall": recall,
    }


def tracking_ratio(found: "Rig", made: "Simulation", clocks: Sequence[Any]) -> float:
    """Return the error of joints tracked with these cameras, divided by that with the true ones."""
    from trecsim.geometry import Rig

    true = Rig(tuple(
        replace(camera, time_offset_s=-clock.stamp_error_s, time_ref_s=clock.stamp_error_s,
                time_drift_ppm=1e6 * (1.0 / (1.0 + 1e-6 * clock.drift_ppm) - 1.0))
        for camera, clock in zip(made.rig, clocks, strict=True)
    ))  # fmt: skip
    return tracking_error_m(found, true, made) / tracking_error_m(true, true, made)


def tracking_error_m(rig: "Rig", true: "Rig", made: "Simulation") -> float:
    """Return the mean error of the joints of all confirmed people tracked with a rig [m]."""
    from trecsim.tracking import follow

    turn, at_m, true_at_m = common_motion(rig, true)
    first = true[rig.names[0]]
    poses = (one for one in made.poses if one.camera in rig.names)
    errors = []
    for snapshot in follow(poses, rig):
        stamp_s = rig.cameras[0].stamp_s(snapshot.t_s)
        moment = int(np.abs(made.truth_t_s - first.time_s(stamp_s)).argmin())
        people = snapshot.confirmed()
        placed_m = (people.xyz_m - at_m) @ turn + true_at_m
        off_m = np.linalg.norm(placed_m[:, None] - made.truth_xyz_m[None, :, moment], axis=-1)
        each_m = np.fmin.reduce(off_m.mean(axis=-1), axis=1, initial=np.inf)
        errors.extend(each_m[each_m < 0.5])
    return float(np.mean(errors))


def common_motion(rig: "Rig", true: "Rig") -> tuple[Array, Array, Array]:
    """Return turn and middles that bring the cameras of a rig nearest to the true ones."""
    pairs = [(camera, true[camera.name]) for camera in rig]
    R, Q = (np.array([pair[n].T_cam_world[:3, :3] for pair in pairs]) for n in (0, 1))
    p, q = (np.array([pair[n].position_m for pair in pairs]) for n in (0, 1))
    return common_turn(R, Q), p.mean(axis=0), q.mean(axis=0)


def common_turn(R: Array, Q: Array) -> Array:
    """Return the turn of the world that brings rotations nearest to others."""
    left, _, right = np.linalg.svd(np.einsum("cji,cjk->ik", R, Q))
    common: Array = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    return common


def angle_deg(R: Array) -> float:
    """Return the angle of a rotation [degrees]."""
    from trecsim.geometry.rigid import rotation_vector

    return float(np.degrees(np.linalg.norm(rotation_vector(R))))


def clock_errors(found: "list[Any]", clocks: "list[Any]") -> tuple[Array, Array]:
    """Return by how much each clock is off at the middle of the recording [s], and drifts [ppm]."""
    ref_s = found[0].time_ref_s
    rate = np.array([1.0 + 1e-6 * clock.drift_ppm for clock in clocks])
    true_s = np.array(
        [(ref_s - clock.stamp_error_s) / r for clock, r in zip(clocks, rate, strict=True)]
    )
    found_s = np.array([camera.time_s(ref_s) for camera in found])
    late = (found_s - found_s[0]) - (true_s - true_s[0]) * rate[0]
    drift = np.array([camera.time_drift_ppm for camera in found])
    wanted = 1e6 * (rate[0] / rate - 1.0)
    return np.abs(late[1:] if len(late) > 1 else late), np.abs((drift - wanted)[1:])


def association(
    done: "PeopleCalibration", made: "Simulation", clocks: Sequence[Any]
) -> tuple[float, float]:
    """Return which share of the pairs of tracklets in a chain are one person, and of those, found.

    Weighted by the time that a pair has in common.
    """
    found = done.found
    who = [person_of(track, made, clocks[track.camera]) for track in found.tracks]
    right = together = same = 0.0
    for i, a in enumerate(found.tracks):
        for j in range(i):
            b = found.tracks[j]
            if a.camera == b.camera or who[i] < 0 or who[j] < 0:
                continue
            spans = [found.rig.state.time_s(one.camera, one.t_s[[0, -1]]) for one in (a, b)]
            common_s = min(s[1] for s in spans) - max(s[0] for s in spans)
            if common_s <= 0.0:
                continue
            joined = found.chain[i] >= 0 and found.chain[i] == found.chain[j]
            together += joined * common_s
            same += (who[i] == who[j]) * common_s
            right += (joined and who[i] == who[j]) * common_s
    return right / together if together else np.nan, right / same if same else np.nan


def person_of(track: Any, made: "Simulation", clock: Any) -> int:
    """Return the person that a tracklet shows most of the time; -1 for a false positive."""
    camera = made.rig.cameras[track.camera]
    images = sorted(
        (one for one in made.poses if one.camera == camera.name), key=lambda one: one.t_s
    )
    first = np.cumsum([0, *(len(one.xy_px) for one in images)])
    votes = []
    for number in track.detections[:: max(1, len(track.detections) // 12)]:
        image = int(np.searchsorted(first, number, side="right")) - 1
        t_s = images[image].t_s
        true_s = (t_s - clock.stamp_error_s) / (1.0 + 1e-6 * clock.drift_ppm)
        at = int(np.clip(round(true_s * 50.0), 0, len(made.truth_t_s) - 1))
        with np.errstate(all="ignore"):
            px = camera.project(made.truth_xyz_m[:, at])
        found = images[image].xy_px[number - first[image]]
        gap = np.nanmedian(
            np.where(np.isfinite(px).all(axis=(1, 2))[:, None], np.linalg.norm(px - found, axis=-1),
                     1e9),
            axis=1,
        )  # fmt: skip
        votes.append(int(np.argmin(gap)) if gap.min() < 60.0 else -1)
    values, counts = np.unique(votes, return_counts=True)
    return int(values[np.argmax(counts)])


def figures_of(case: Case, runs: Mapping[int, Run]) -> dict[str, Figure | Figures]:
    """Return the figures of a kind of recording."""
    good = {seed: one for seed, one in runs.items() if not one["failed"]}
    counted = {
        "failed": summed({seed: one["failed"] for seed, one in runs.items()}),
        "cameras lost": summed({seed: one["lost"] for seed, one in good.items()}),
    }
    if not good:
        return dict(counted)
    turns = np.concatenate([one["rotation_deg"] for one in good.values()])
    verdicts = {seed: one["verdict"] for seed, one in good.items()}
    worst = {seed: float(one["rotation_deg"].max()) for seed, one in good.items()}
    near = [seed for seed in good if worst[seed] <= 0.3]
    return {
        **counted,
        "rotation": once(float(np.median(turns)), "deg", "lower"),
        "worst camera": once(float(turns.max()), "deg", "lower"),
        "rotation per seed": over_seeds(
            {s: float(np.median(one["rotation_deg"])) for s, one in good.items()}, "deg"
        ),
        "upright": over_seeds({s: one["upright_deg"] for s, one in good.items()}, "deg"),
        "position": over_seeds(
            {s: 100 * float(np.median(one["position_m"])) for s, one in good.items()}, "cm"
        ),
        "scale": over_seeds({s: 100 * one["scale"] for s, one in good.items()}, "%"),
        "offset": over_seeds(
            {s: 1e3 * float(one["late_s"].max()) for s, one in good.items()}, "ms"
        ),
        "drift": over_seeds({s: float(one["drift_ppm"].max()) for s, one in good.items()}, "ppm"),
        "precision": over_seeds({s: one["precision"] for s, one in good.items()}, "", "higher"),
        "recall": over_seeds({s: one["recall"] for s, one in good.items()}, "", "higher"),
        "turns in the 90 % region": over_seeds(
            {s: 100 * one["held_turn"] for s, one in good.items()}, "%", "higher"
        ),
        "places in the 90 % region": over_seeds(
            {s: 100 * one["held_place"] for s, one in good.items()}, "%", "higher"
        ),
        "tracking": over_seeds({s: one["tracking"] for s, one in good.items()}, "x"),
        "called good": summed({s: v == "good" for s, v in verdicts.items()}, "", "higher"),
        "called wrong": summed({s: v == "wrong" for s, v in verdicts.items()}, ""),
        "good though off by 1 degree": summed(
            {s: verdicts[s] == "good" and worst[s] > 1.0 for s in good}
        ),
        "good of those within 0.3 degrees": once(
            100 * float(np.mean([verdicts[s] == "good" for s in near])) if near else np.nan, "%",
            "higher",
        ),
        "processor time": once(
            float(np.median([one["cpu_s"] for one in good.values()])), "s", "lower", watched=False
        ),
    }  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
