"""How long reading 2D poses takes, per image.

Read are simulated people with the errors of a real detector, and the Shelf recording where it is
among the data beside the repository.

Run: ``python benchmarks/reading.py``
"""

import tempfile
import time
from pathlib import Path

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figures, Skipped, once, timed
from harness.options import Options, shared_data

ROOMS = ((4, 3, 10.0, 8.0, 6.0), (12, 50, 3.0, 18.0, 13.0))  # cameras, people, seconds, room [m]
SEED = 1000
ROUNDS = 7


def measure(options: Options) -> Figures:
    """Measure how long reading an image's 2D poses takes."""
    from harness.shelf_recording import convert_shelf

    options.input.update(data="simulated rooms", seeds=[SEED, SEED], rounds=ROUNDS)
    figures: dict[str, Figures] = {}
    with tempfile.TemporaryDirectory() as folder:
        for cameras, people, *room in ROOMS:
            path = Path(folder) / f"{people}.poses.jsonl"
            write_room(path, cameras, people, room)
            figures[f"{cameras} cameras, {people} people"] = of_file(path)
        try:
            convert_shelf(shared_data("shelf"), folder)
        except Skipped as reason:
            options.skipped["Shelf"] = str(reason)
        else:
            figures["Shelf"] = of_file(Path(folder) / "poses.jsonl")
    return figures


def write_room(path: Path, cameras: int, people: int, room: list[float]) -> None:
    """Write what the cameras of a simulated room see."""
    from trecsim.lab.simulation.scene import room_scene, simulate
    from trecsim.store.poses_writer import PosesWriter

    seconds, width_m, depth_m = room
    scene = room_scene(
        people=people, cameras=cameras, seconds=seconds, width_m=width_m, depth_m=depth_m
    )
    with PosesWriter(path) as writer:
        for image in simulate(scene, SEED).poses:
            writer.write(image)


def of_file(path: Path) -> Figures:
    """Return the time per image, and how many people and bytes an image has."""
    from trecsim.sources import read_poses

    took_us, used_us, calibration = [], [], []
    images = people = 0
    for _ in range(ROUNDS):
        before_ms = calibration_ms()
        began_s, cpu_s = time.perf_counter(), time.process_time()
        counts = [len(image.xy_px) for image in read_poses(path)]
        images, people = len(counts), sum(counts)
        took_us.append(1e6 * (time.perf_counter() - began_s) / images)
        used_us.append(1e6 * (time.process_time() - cpu_s) / images)
        calibration.append((before_ms + calibration_ms()) / 2)
    return {
        "wall time": timed(took_us, calibration, "us", used=used_us),
        "processor time, least": once(min(used_us), "us", watched=False),
        "people in an image": once(people / images, "", watched=False),
        "size of an image": once(path.stat().st_size / images, "bytes", watched=False),
    }


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
