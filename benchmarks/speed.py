"""How long the fusion takes per frame set, over people and cameras (the thesis' tables 5 and 6).

A frame set is one image of each camera. Timed is the whole call of `Tracker.step`, association and
fit, in one thread, after everything is compiled and everybody has come in, which takes a bit more
than a third of a scene. For some sites the worst step while people come in is measured, too, with
all of them in view of the first images; there the processor's time counts. Rooms grow with the
people, so that they do not stand closer than in the smaller ones. Cameras are ideal ones without
distortion; for some sites the same is timed through lenses, whose distortion costs time for every
key point.

Run: ``python benchmarks/speed.py``
"""

import time
from collections.abc import Callable
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figure, Figures, once, over_seeds, timed
from harness.options import Options

if TYPE_CHECKING:
    import numpy as np

    from trecsim.fusion import FusionSettings
    from trecsim.lab.simulation.scene import Scene, Simulation

PEOPLE = (1, 2, 3, 4, 6, 10, 20, 50)
CAMERAS = (2, 4, 8, 12)
FEW_VIEWS = 10  # more people than this with two cameras is no sensible site
QUICK_CELLS = ((2, 3), (4, 4), (4, 10), (12, 10))
LENSED_CELLS = ((2, 3), (4, 4))
LENSED = "per frame set, through lenses"
ARRIVAL_CELLS = ((4, 10), (4, 50), (12, 50))
ARRIVAL = "while people come in, all at once"
ARRIVAL_STEPS = 25
SECONDS, WARM_S = 6.0, 2.4  # until then the last ones come in, and their tracks begin
FPS = 25.0
ROUNDS = 5
SEEDS = (1000, 1001, 1002)
MEANT = 4  # people and cameras from which on growth is fitted: below, what is fixed dominates


def cells(quick: bool) -> list[tuple[int, int]]:
    """Return the numbers of cameras and people that are measured."""
    if quick:
        return list(QUICK_CELLS)
    return [(c, p) for c in CAMERAS for p in PEOPLE if not (c == 2 and p > FEW_VIEWS)]


def cell_name(cameras: int, people: int) -> str:
    """Return what a cell is called in the results."""
    return f"{cameras} cameras, {people} people"


def room_size_m(people: int) -> tuple[float, float]:
    """Return width and depth of the room for so many people [m]."""
    grown = max(1.0, (people / 10) ** 0.5)
    return round(8.0 * grown, 1), round(6.0 * grown, 1)


def room(cameras: int, people: int, *, lensed: bool = False) -> "Scene":
    """Return a room with so many cameras and people, `lensed` where the cameras have lenses."""
    from trecsim.lab.simulation.camera_placement import Make
    from trecsim.lab.simulation.room import Floor, pattern_rig
    from trecsim.lab.simulation.scene import room_scene

    width_m, depth_m = room_size_m(people)
    scene = room_scene(
        people=people, cameras=cameras, seconds=SECONDS, width_m=width_m, depth_m=depth_m, fps=FPS
    )
    if not lensed:
        return scene
    floor = Floor(width_m, depth_m, scene.rig.cameras[0].position_m[2])
    return replace(scene, rig=pattern_rig("corners", floor, cameras, Make(lens="brown")))


def cell(scene: "Scene", options: Options) -> dict[str, Figure]:
    """Return the figures of one scene."""
    import numpy as np

    from trecsim.lab.simulation.scene import simulate

    made = [simulate(scene, seed) for seed in SEEDS]
    settings = options.settings()
    calibrated_ms = calibration_ms()
    took = []
    for _ in range(ROUNDS):
        took.append(np.concatenate([warm_steps_ms(one, settings) for one in made]))
        calibrated_ms = min(calibrated_ms, calibration_ms())
    rounds, used = (np.array(took)[..., n] for n in (0, 1))
    # A busy machine empties the caches now and then, and a step right after that takes longer.
    # Each step is the same in every round, so the least it took is what it takes by itself;
    # leaving one round out at a time tells how well that is known.
    least = [np.delete(used, n, axis=0).min(axis=0) for n in range(ROUNDS)]
    takes: dict[str, Callable[[Any], Any]] = {
        "median": np.median,
        "p95": lambda ms: np.quantile(ms, 0.95),
        "mean": np.mean,
        "std": np.std,
        "max": np.max,
        "min": np.min,
    }
    found = {
        name: timed(
            [float(take(ms)) for ms in rounds],
            [calibrated_ms] * ROUNDS,
            used=[float(take(ms)) for ms in least],
            watched=name in WATCHED,
        )
        for name, take in takes.items()
    }
    ratios = {n: float(np.quantile(ms, 0.95) / np.median(ms)) for n, ms in enumerate(rounds)}
    found["p95 / median"] = replace(over_seeds(ratios, ""), watched=False)
    return found


WATCHED = ("median", "p95")


def arrival(scene: "Scene", options: Options) -> dict[str, Figure]:
    """Return what the worst step takes when everybody is in view of the first images."""
    import numpy as np

    from trecsim.lab.simulation.scene import simulate

    made = [simulate(scene, seed) for seed in SEEDS]
    later = [replace(one, poses=tuple(p for p in one.poses if p.t_s >= WARM_S)) for one in made]
    settings = options.settings()
    took = [[steps_ms(one, settings, ARRIVAL_STEPS) for one in later] for _ in range(ROUNDS)]
    # As for the other steps, the least that each took is what it takes by itself.
    used = np.array(took)[..., 1]
    worst = [float(np.delete(used, n, axis=0).min(axis=0).max()) for n in range(ROUNDS)]
    return {"worst step": timed(worst, [calibration_ms()] * ROUNDS)}


def warm_steps_ms(made: "Simulation", settings: "FusionSettings") -> "np.ndarray":
    """Return wall and processor time of every frame set but the first ones [ms]."""
    return steps_ms(made, settings)[int(WARM_S * FPS) :]


def steps_ms(
    made: "Simulation", settings: "FusionSettings", most: int | None = None
) -> "np.ndarray":
    """Return wall and processor time of every frame set, or of the first `most` of them [ms]."""
    import numpy as np

    from trecsim import Tracker, frame_sets

    tracker = Tracker(made.rig, settings)
    took_ms = []
    for frame_set in islice(frame_sets(made.poses), most):
        began_s, used_s = time.perf_counter(), time.thread_time()
        tracker.step(frame_set)
        used_ms = 1e3 * (time.thread_time() - used_s)
        took_ms.append((1e3 * (time.perf_counter() - began_s), used_ms))
    return np.array(took_ms)


def growth(figures: dict[str, dict[str, Figure]], counts: list[tuple[int, int]]) -> Figures:
    """Return the exponents of the median's growth with people and cameras."""
    out: dict[str, Figures] = {}
    for name, least in (("all", 1), (f"from {MEANT} people and cameras", MEANT)):
        some = [(c, p) for c, p in counts if min(c, p) >= least]
        times = [figures[cell_name(c, p)]["median"].value for c, p in some]
        people, cameras = exponents(some, times)
        out[name] = {
            "people": once(people, "", watched=False),
            "cameras": once(cameras, "", watched=False),
        }
    return out


def exponents(counts: list[tuple[int, int]], times: list[float]) -> tuple[float, float]:
    """Return a and b of the least-squares fit of people^a x cameras^b to times."""
    import numpy as np

    log_counts = np.log(np.array(counts, float))
    left = np.column_stack((np.ones(len(counts)), log_counts[:, 1], log_counts[:, 0]))
    _, a, b = np.linalg.lstsq(left, np.log(times), rcond=None)[0]
    return float(a), float(b)


def measure(options: Options) -> Figures:
    """Measure the fusion's time per frame set over people and cameras, and how it grows."""
    from trecsim.fusion.warmup import warm_up

    counts = cells(options.quick)
    options.input.update(
        seeds=[SEEDS[0], SEEDS[-1]], seconds=SECONDS, left_out_s=WARM_S, fps=FPS, rounds=ROUNDS,
        threads=1, data="simulated rooms",
    )  # fmt: skip
    warm_up()
    times: dict[str, dict[str, Figure]] = {}
    lensed: dict[str, dict[str, Figure]] = {}
    for cameras, people in counts:
        name = cell_name(cameras, people)
        times[name] = cell(room(cameras, people), options)
        options.tell(f"{name}: median {times[name]['median'].value:.2f} ms")
        if (cameras, people) in LENSED_CELLS:
            lensed[name] = cell(room(cameras, people, lensed=True), options)
            options.tell(f"{name}, lenses: median {lensed[name]['median'].value:.2f} ms")
    arrivals: dict[str, Figures] = {}
    for cameras, people in ARRIVAL_CELLS[:1] if options.quick else ARRIVAL_CELLS:
        name = cell_name(cameras, people)
        arrivals[name] = arrival(room(cameras, people), options)
        options.tell(f"{name}, all at once: done")
    figures: dict[str, Figures] = {"per frame set": times, LENSED: lensed, ARRIVAL: arrivals}
    if not options.quick:
        figures["growth"] = growth(times, counts)
    return figures


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
