"""What it costs per frame set to watch whether poses and rig fit together.

Frame sets are examined often at first and ever more rarely later. A simulated room is followed
once, then its frame sets and snapshots are watched several times; each frame set counts as in its
fastest repetition.

Run: ``python benchmarks/consistency_cost.py``
"""

import time
from typing import TYPE_CHECKING

from harness.calibration import calibration_ms
from harness.command import alone
from harness.figures import Figures, once, timed
from harness.options import Options

if TYPE_CHECKING:
    import numpy as np

    from trecsim.geometry import Rig
    from trecsim.values import FrameSet, Snapshot

ROOMS = {"2 cameras, 3 people": (2, 3), "4 cameras, 4 people": (4, 4)}
SECONDS = 180.0
PARTS = {"first 15 s": (0.0, 15.0), "from 2 minutes on": (120.0, SECONDS)}
SEED = 1000
ROUNDS = 3


def measure(options: Options) -> Figures:
    """Measure the time per frame set that the check of poses and rig takes."""
    options.input.update(data="simulated rooms", seeds=[SEED, SEED], seconds=SECONDS, rounds=ROUNDS)
    figures: dict[str, Figures] = {}
    for name, (cameras, people) in ROOMS.items():
        figures[name] = of_room(cameras, people, options)
        options.tell(name)
    return figures


def of_room(cameras: int, people: int, options: Options) -> Figures:
    """Return the time per frame set in each part of a room, and beside that of the fusion."""
    import numpy as np

    from trecsim.fusion import Tracker
    from trecsim.fusion.warmup import warm_up
    from trecsim.lab.simulation.scene import room_scene, simulate
    from trecsim.sync import frame_sets

    warm_up()
    made = simulate(room_scene(people=people, cameras=cameras, seconds=SECONDS), SEED)
    tracker = Tracker(made.rig, options.settings())
    began_s = time.process_time()
    followed = [(one, tracker.step(one)) for one in frame_sets(made.poses)]
    fusion_us = 1e6 * (time.process_time() - began_s) / len(followed)
    calibration, rounds = [], []
    for _ in range(ROUNDS):
        calibration.append(calibration_ms())
        rounds.append(watched_us(made.rig, followed))
    least_us = np.min(rounds, axis=0)
    t_s = np.array([one.t_s for one, _ in followed])
    figures: dict[str, Figures] = {}
    for name, (from_s, until_s) in PARTS.items():
        within = (from_s <= t_s) & (t_s < until_s)
        figures[name] = {
            "per frame set": timed([float(us[within].mean()) for us in rounds], calibration, "us"),
            "per frame set, least": once(least_us[within].mean(), "us", watched=False),
            "share of the fusion": once(least_us[within].mean() / fusion_us, "", watched=False),
        }
    figures["whole"] = {"longest": once(1e-3 * least_us.max(), "ms", watched=False)}
    return figures


def watched_us(rig: "Rig", followed: "list[tuple[FrameSet, Snapshot]]") -> "np.ndarray":
    """Return the processor time of each frame set [us]; nothing may be said of a good room."""
    import numpy as np

    from trecsim.consistency import Consistency

    watch, took_us = Consistency(rig), []
    for frame_set, snapshot in followed:
        began_s = time.thread_time()
        said = watch.observe(frame_set, snapshot)
        took_us.append(1e6 * (time.thread_time() - began_s))
        if said:
            raise RuntimeError(f"said of a room without a fault: {said}")
    return np.array(took_us)


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
