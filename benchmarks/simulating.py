"""How fast scenes are simulated, as a multiple of real time.

Run: ``python benchmarks/simulating.py``
"""

import time

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figures, once, timed
from harness.options import Options

SCENES = ((4, 4, 20.0, 8.0, 6.0), (12, 50, 6.0, 18.0, 13.0))  # cameras, people, seconds, room
ROUNDS = 3


def measure(options: Options) -> Figures:
    """Measure how much faster than real time scenes are simulated."""
    from trecsim.lab.simulation.scene import room_scene, simulate

    options.input.update(seeds=[1000, 1000 + ROUNDS - 1], data="simulated rooms", fps=25.0)
    simulate(room_scene(seconds=1.0), 0)
    figures: dict[str, Figures] = {}
    for cameras, people, seconds, width_m, depth_m in SCENES:
        scene = room_scene(
            people=people, cameras=cameras, seconds=seconds, width_m=width_m, depth_m=depth_m
        )
        took_s, used_s, calibration = [], [], []
        for number in range(ROUNDS):
            before_ms = calibration_ms()
            began_s, processor_s = time.perf_counter(), time.process_time()
            simulate(scene, 1000 + number)
            used_s.append((time.process_time() - processor_s) / seconds)
            took_s.append(time.perf_counter() - began_s)
            calibration.append((before_ms + calibration_ms()) / 2)
        per_second = timed([s / seconds for s in took_s], calibration, "s", used=used_s)
        name = f"{cameras} cameras, {people} people"
        figures[name] = {
            "time per second of scene": per_second,
            "times real time": once(1.0 / per_second.value, "", "higher", watched=False),
        }
        options.tell(f"{name}: {1.0 / per_second.value:.1f} x real time")
    return figures


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
