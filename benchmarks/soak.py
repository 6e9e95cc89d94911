"""Whether anything grows, slows down or is lost in a long recording in which much goes wrong.

Three cameras look at a room in which people come and go and one stands still all the time. One
camera after the other is silent, late, frozen, blind, sees a hundred people who are not there, or
has a wrong clock. A scene of two minutes is gone through again and again, with other failures each
time; nothing of it is stored.

Run: ``python benchmarks/soak.py``, or with ``--hours 24`` a whole day
"""

import argparse
import heapq
import math
import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figures, once
from harness.machine import held_mb
from harness.options import Options

if TYPE_CHECKING:
    from trecsim.lab.simulation.scene import Simulation
    from trecsim.values import Poses2D, Snapshot

HOURS, QUICK_HOURS = 1.0, 0.1
SHORTEST_HOURS, LONGEST_HOURS = 0.02, 240.0
SCENE_S, FPS, CAMERAS, VISITS = 120.0, 10.0, 3, 10
STANDING_M, CLEAR_M = (0.6, 0.4), 0.8
TROUBLES = ("silent", "late", "clock", "frozen", "blind", "odd", "crowd")
EVERY_S, LONGEST_S = 45.0, 30.0  # a camera's troubles: how often, and for how long at most
AT_ONCE = 1
LOST, FALSE = 0.02, 0.05  # shares of images
KEPT = {
    "people": "tracks", "leftover detections": "unassigned", "lost people": "dead",
    "close pairs": "close_pairs",
}  # fmt: skip


def scene() -> "Simulation":
    """Return two minutes of a room: the first person stands, the others walk through."""
    import numpy as np

    from trecsim.lab.simulation.detector_errors import Detector
    from trecsim.lab.simulation.paths import through
    from trecsim.lab.simulation.room import corner_rig
    from trecsim.lab.simulation.scene import Clock, PathWalkers, Scene, simulate

    rng = np.random.default_rng(1000)
    paths = [through(np.array([0.0, SCENE_S]), np.array([STANDING_M, STANDING_M]))]
    for enter_s in np.sort(rng.uniform(0.0, SCENE_S - 12.0, VISITS)):
        ends = rng.uniform([-3.0, -2.5], [3.0, 2.5], (2, 2))
        while clearance_m(ends) < CLEAR_M:  # nobody walks through somebody
            ends = rng.uniform([-3.0, -2.5], [3.0, 2.5], (2, 2))
        paths.append(through(enter_s + np.array([0.0, rng.uniform(4.0, 12.0)]), ends))
    clocks = tuple(Clock(FPS, start_s=n / CAMERAS / FPS) for n in range(CAMERAS))
    rig = corner_rig(7.0, 6.0, 2.7, CAMERAS)
    made = simulate(Scene(rig, PathWalkers(tuple(paths)), SCENE_S, Detector(), clocks), 1000)
    return replace(made, truth_xyz_m=made.truth_xyz_m[:1].copy())


def clearance_m(ends: Any) -> float:
    """Return how far from the one who stands a straight way passes [m]."""
    import numpy as np

    way = np.linspace(ends[0], ends[1], 50)
    return float(np.linalg.norm(way - STANDING_M, axis=1).min())


@dataclass(slots=True)
class Camera:
    """What is wrong with one camera now."""

    trouble: str = ""
    until_s: float = 0.0
    amount: float = 0.0
    picture: "Poses2D | None" = None
    arrival_s: float = 0.0


@dataclass(slots=True)
class Failing:
    """Cameras that fail, one after the other."""

    rng: Any
    cameras: dict[str, Camera] = field(default_factory=dict)

    def images(self, made: "Simulation", seconds: float) -> Iterator["Poses2D"]:
        """Yield what arrives, in order of arrival."""
        waiting: list[tuple[float, int, Poses2D]] = []
        number = 0
        for turn in range(int(seconds / SCENE_S) + 1):
            for image in made.poses:
                t_s = image.t_s + turn * SCENE_S
                if t_s > seconds:
                    break
                sent = self.sent(replace(image, t_s=t_s), t_s)
                if sent is not None:
                    number += 1
                    heapq.heappush(waiting, (self.arrival_s(image.camera, t_s), number, sent))
                while waiting and waiting[0][0] <= t_s:
                    yield heapq.heappop(waiting)[2]
        while waiting:
            yield heapq.heappop(waiting)[2]

    def arrival_s(self, name: str, t_s: float) -> float:
        """Return when an image of `t_s` arrives: not before an earlier one of its camera."""
        camera = self.cameras[name]
        late_s = camera.amount if camera.trouble == "late" else 0.0
        camera.arrival_s = max(camera.arrival_s, t_s + late_s)
        return camera.arrival_s

    def sent(self, image: "Poses2D", t_s: float) -> "Poses2D | None":
        """Return what a camera makes of an image."""
        camera = self.cameras.setdefault(image.camera, Camera())
        if camera.trouble and t_s > camera.until_s:
            camera.trouble, camera.picture = "", None
        failing = sum(bool(one.trouble) for one in self.cameras.values())
        if failing < AT_ONCE and self.rng.random() < 1.0 / (FPS * EVERY_S):
            camera.trouble = str(self.rng.choice(TROUBLES))
            camera.until_s = t_s + self.rng.uniform(1.0, LONGEST_S)
            camera.amount = self.rng.uniform(0.1, 0.9)
            if camera.trouble == "clock":
                camera.amount = self.rng.choice([-1.0, 1.0]) * 10.0 ** self.rng.uniform(0.0, 9.0)
        if camera.trouble == "silent" or self.rng.random() < LOST:
            return None
        return self.spoilt(image, camera)

    def spoilt(self, image: "Poses2D", camera: Camera) -> "Poses2D":
        """Return an image with what is wrong in it."""
        import numpy as np

        match camera.trouble:
            case "clock":
                return replace(image, t_s=image.t_s + camera.amount)
            case "frozen":
                camera.picture = camera.picture or image
                return replace(camera.picture, t_s=image.t_s)
            case "blind":
                return crowded(image, 0, self.rng, keep=0)
            case "odd":
                xy_px = image.xy_px.copy()
                share = self.rng.random(xy_px.shape[:2]) < 0.5
                xy_px[share] = self.rng.choice([np.nan, np.inf, 1e300, -1e20])
                return replace(image, xy_px=xy_px)
            case "crowd":
                return crowded(image, 100, self.rng)
        return crowded(image, 1, self.rng) if self.rng.random() < FALSE else image


def crowded(image: "Poses2D", count: int, rng: Any, keep: int | None = None) -> "Poses2D":
    """Return an image with so many people more who are not there."""
    import numpy as np

    xy_px = image.xy_px[:keep]
    false = rng.normal(0.0, 80.0, (count, 17, 2)) + rng.uniform(0.0, 1080.0, (count, 1, 2))
    if len(xy_px) and count:
        body = xy_px[rng.integers(len(xy_px), size=count)]
        false = body + rng.uniform(-600.0, 600.0, (count, 1, 2))
    from trecsim.values import Poses2D

    return Poses2D(
        image.camera,
        image.t_s,
        np.concatenate([xy_px, false]),
        np.concatenate([image.score[:keep], rng.uniform(0.2, 0.9, (count, 17))]),
        np.ones(len(xy_px) + count),
    )


class Part:
    """A tenth of the recording: what each frame set cost, and how far off the one who stands is."""

    def __init__(self, sets: int) -> None:
        import numpy as np

        self.step_ms = np.full(sets, np.nan)  # allocated before memory is looked at
        self.error_m = np.full(sets, np.nan)
        self.count = 0
        self.calibration_ms: list[float] = []

    def note(self, step_ms: float, error_m: float) -> None:
        """Write down one frame set."""
        if self.count % (len(self.step_ms) // 40) == 0:
            self.calibration_ms.append(calibration_ms())
        if self.count < len(self.step_ms):
            self.step_ms[self.count], self.error_m[self.count] = step_ms, error_m
            self.count += 1


class Seen:
    """What came of the recording."""

    def __init__(self, made: "Simulation", seconds: float) -> None:
        self.seconds = seconds
        self.parts = {
            name: Part(max(int(0.2 * seconds * FPS), 40)) for name in ("first tenth", "last tenth")
        }
        self.most = dict.fromkeys(KEPT, 0)
        self.raised = self.not_finite = self.count = self.missed = 0
        self.who: set[int] = set()
        self._truth = made.truth_xyz_m[0]
        self._step_s = made.truth_t_s[1] - made.truth_t_s[0]

    def note(self, snapshot: "Snapshot", took_ms: float, tracker: Any) -> None:
        """Write down one frame set."""
        import numpy as np

        error_m = self.error_m(snapshot)
        if snapshot.t_s < 0.1 * self.seconds:
            self.parts["first tenth"].note(took_ms, error_m)
        elif snapshot.t_s > 0.9 * self.seconds:
            self.parts["last tenth"].note(took_ms, error_m)
        self.count += 1
        self.missed += error_m != error_m
        for name, attribute in KEPT.items():
            self.most[name] = max(self.most[name], getattr(tracker.held, attribute))
        finite = np.isfinite(snapshot.xyz_m).all() and np.isfinite(snapshot.cov_m2).all()
        self.not_finite += not finite

    def error_m(self, snapshot: "Snapshot") -> float:
        """Return how far off the one who stands is, NaN if missed; note the identity."""
        import numpy as np

        if not len(snapshot.id):
            return float("nan")
        at = min(int(snapshot.t_s % SCENE_S / self._step_s), len(self._truth) - 1)
        away_m = np.linalg.norm(snapshot.xyz_m - self._truth[at], axis=-1).mean(axis=1)
        nearest = int(away_m.argmin())
        if not away_m[nearest] < 0.4:
            return float("nan")
        self.who.add(int(snapshot.id[nearest]))
        return float(away_m[nearest])


def follow(made: "Simulation", seconds: float, options: Options) -> Figures:
    """Follow everybody for so long."""
    import numpy as np

    from trecsim.fusion import Tracker
    from trecsim.fusion.warmup import warm_up
    from trecsim.sync import frame_sets

    warm_up()
    calibration_ms()
    tracker, seen = Tracker(made.rig, options.settings()), Seen(made, seconds)
    memory_mb = [held_mb()]
    tenth_s = 0.1 * seconds
    for frame_set in frame_sets(Failing(np.random.default_rng(1000)).images(made, seconds)):
        began_s = time.thread_time()
        try:
            snapshot = tracker.step(frame_set)
        except Exception:  # what this looks for
            seen.raised += 1
            continue
        seen.note(snapshot, 1e3 * (time.thread_time() - began_s), tracker)
        if snapshot.t_s > tenth_s * len(memory_mb):
            options.tell(f"{snapshot.t_s / 3600.0:.2f} h: {held_mb():.0f} MB")
            memory_mb.append(held_mb())
    return figures_of(seen, [*memory_mb, held_mb()])


def figures_of(seen: Seen, memory_mb: list[float]) -> Figures:
    """Return all figures; `memory_mb` is that at the start and after each tenth."""
    import numpy as np

    times: dict[str, Any] = {}
    errors: dict[str, Any] = {}
    for name, part in seen.parts.items():
        step_ms = part.step_ms[: part.count]
        times[f"{name}, median"] = once(float(np.median(step_ms)), "ms", watched=False)
        times[f"{name}, p95"] = once(float(np.quantile(step_ms, 0.95)), "ms", watched=False)
        errors[f"error, {name}"] = once(100.0 * float(np.nanmean(part.error_m)), "cm")
    for what in ("median", "p95"):
        first, last = (
            times[f"{name}, {what}"].value / statistics.median(part.calibration_ms)
            for name, part in seen.parts.items()
        )
        times[f"last / first, {what}, by the calibration"] = once(last / first, "", matters=0.15)
    began_mb, warm_mb, end_mb = memory_mb[0], memory_mb[1], memory_mb[-1]
    return {
        "length": {"of the recording": once(seen.seconds / 3600.0, "h", watched=False),
                   "frame sets": once(seen.count, "", watched=False)},
        "memory": {
            "at the start": once(began_mb, "MB", watched=False),
            "after a tenth": once(warm_mb, "MB", watched=False),
            "at the end": once(end_mb, "MB", watched=False),
            "growth since a tenth": once(end_mb - warm_mb, "MB", matters=5.0),
        },
        "time per frame set": times,
        "at most": {name: once(most, "", matters=0.2 * most) for name, most in seen.most.items()},
        "faults": {
            "exceptions": once(seen.raised, "", matters=0.5),
            "snapshots with a joint that is not finite": once(seen.not_finite, "", matters=0.5),
        },
        "somebody who stands throughout": {
            "identities": once(len(seen.who), "", matters=0.5),
            "missed": once(100.0 * seen.missed / seen.count, "%", matters=0.5),
            **errors,
        },
    }  # fmt: skip


def hours(text: str) -> float:
    """Return `text` as a length of recording that has a first and a last tenth [h]."""
    try:
        length_h = float(text)
    except ValueError:
        length_h = math.nan
    if not SHORTEST_HOURS <= length_h <= LONGEST_HOURS:
        raise argparse.ArgumentTypeError(
            f"expected {SHORTEST_HOURS:g} to {LONGEST_HOURS:g} hours, got {text}"
        )
    return length_h


def main() -> int:
    """Run it for as many hours as asked."""
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--hours", type=hours, metavar="N")
    given, others = parser.parse_known_args()

    def measure(options: Options) -> Figures:
        """Follow people for long, with cameras that fail; watch memory, time and who is lost."""
        length_h = given.hours or (QUICK_HOURS if options.quick else HOURS)
        options.input.update(hours=length_h, data="a simulated room, 3 failing cameras", fps=FPS)
        return follow(scene(), 3600.0 * length_h, options)

    if "--help" in others:
        print("soak.py takes --hours N, of recording, besides what all benchmarks take:\n")
    return alone(__file__, measure, others)


if __name__ == "__main__":
    sys.exit(main())
