"""Images taken in together, or each by itself as it arrives: the same result, and at what cost.

The same simulated rooms are followed twice: frame set by frame set, and image by image in the order
of their times. Compared are the places of the same joints at the end of each frame set, once a
second has passed, who is there, and the errors against the truth.

Run: ``python benchmarks/arrival.py``
"""

import math
import statistics
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from harness.command import alone
from harness.figures import Figure, Figures, once, over_seeds, summed
from harness.options import Options

if TYPE_CHECKING:
    from trecsim.fusion import FusionSettings
    from trecsim.values import FrameSet, Snapshot

SCENES = {"4 cameras, 4 people": (4, 4), "2 cameras, 3 people": (2, 3)}
SECONDS, SETTLED_S = 10.0, 1.0
NEAR_M = 0.5
Figured = dict[str, tuple[Callable[[dict[int, float], str], Figure], str]]
FIGURES: Figured = {
    "joints apart, median": (over_seeds, "mm"),
    "joints apart, 95 % within": (over_seeds, "mm"),
    "error together": (over_seeds, "cm"),
    "error one by one": (over_seeds, "cm"),
    "frame sets with another number of people": (summed, ""),
    "switches together": (summed, ""),
    "switches one by one": (summed, ""),
}


def measure(options: Options) -> Figures:
    """Compare taking images in together with taking them in one by one."""
    seeds = options.seeds(8, 2)
    options.input.update(seeds=[seeds[0], seeds[-1]], seconds=SECONDS, data="simulated rooms")
    figures: dict[str, Figures] = {}
    for name, (cameras, people) in SCENES.items():
        done = {seed: both_ways(cameras, people, seed, options.settings()) for seed in seeds}
        options.tell(name)
        group: dict[str, Figure] = {
            key: kind({seed: found[key] for seed, found in done.items()}, unit)
            for key, (kind, unit) in FIGURES.items()
        }
        cost = {
            way: statistics.median(found[f"time {way}"] for found in done.values())
            for way in ("together", "one by one")
        }
        for way, took_ms in cost.items():
            group[f"time per image {way}"] = once(took_ms, "ms", watched=False)
        ratio = cost["one by one"] / cost["together"]
        group["time one by one / together"] = once(ratio, "", matters=0.2 * ratio)
        figures[name] = group
    return figures


def both_ways(cameras: int, people: int, seed: int, settings: "FusionSettings") -> dict[str, float]:
    """Follow one room both ways; return what is to be compared."""
    import numpy as np

    from trecsim.fusion import Tracker
    from trecsim.fusion.warmup import warm_up
    from trecsim.lab.simulation.scene import room_scene, simulate
    from trecsim.sync import frame_sets

    warm_up()
    made = simulate(room_scene(people=people, cameras=cameras, seconds=SECONDS), seed)
    ways = {name: Tracker(made.rig, settings) for name in ("together", "one by one")}
    took_s, last, scores = dict.fromkeys(ways, 0.0), {}, {name: Score(made) for name in ways}
    apart_m, others = [], 0
    for frame_set in frame_sets(made.poses):
        for name, tracker in ways.items():
            parts = [frame_set] if name == "together" else singles(frame_set)
            began_s = time.thread_time()
            for part in parts:
                last[name] = tracker.step(part)
            took_s[name] += time.thread_time() - began_s
        if frame_set.t_s > SETTLED_S:
            one, other = last.values()
            others += len(one.id) != len(other.id)
            apart_m += distances(one, other)
            for name, score in scores.items():
                score.note(last[name])
    found: dict[str, float] = {
        "joints apart, median": 1e3 * float(np.median(apart_m)),
        "joints apart, 95 % within": 1e3 * float(np.quantile(apart_m, 0.95)),
        "frame sets with another number of people": others,
    }
    for name, score in scores.items():
        found[f"error {name}"] = 100.0 * statistics.fmean(score.error_m)
        found[f"switches {name}"] = score.switches
        found[f"time {name}"] = 1e3 * took_s[name] / len(made.poses)
    return found


def singles(frame_set: "FrameSet") -> "list[FrameSet]":
    """Return every image of a frame set as one of its own."""
    from trecsim.values import FrameSet

    return [FrameSet(view.t_s, (view,)) for view in sorted(frame_set.views, key=lambda v: v.t_s)]


def distances(one: "Snapshot", other: "Snapshot") -> list[float]:
    """Return how far apart the joints of the people are who are in both [m]."""
    import numpy as np

    if not len(one.id) or not len(other.id):
        return []
    apart_m = np.linalg.norm(one.xyz_m[:, None] - other.xyz_m[None], axis=-1)
    nearest = apart_m.mean(axis=-1).argmin(axis=1)
    joints_m = apart_m[np.arange(len(nearest)), nearest]
    return [float(m) for row in joints_m if row.mean() < NEAR_M for m in row]


class Score:
    """Errors against the truth, and changes of identity."""

    def __init__(self, made: Any) -> None:
        self.error_m: list[float] = []
        self.switches = 0
        self._made = made
        self._who: dict[int, int] = {}

    def note(self, snapshot: "Snapshot") -> None:
        """Compare one snapshot with the truth at its time."""
        import numpy as np

        step_s = self._made.truth_t_s[1] - self._made.truth_t_s[0]
        at = min(round(snapshot.t_s / step_s), len(self._made.truth_t_s) - 1)
        for person, truth_m in enumerate(self._made.truth_xyz_m[:, at]):
            away_m = np.linalg.norm(snapshot.xyz_m - truth_m, axis=-1).mean(axis=1)
            if not len(away_m) or not math.isfinite(away_m[0]) or away_m.min() >= NEAR_M:
                continue
            self.error_m.append(float(away_m.min()))
            identity = int(snapshot.id[away_m.argmin()])
            self.switches += self._who.get(person, identity) != identity
            self._who[person] = identity


if __name__ == "__main__":
    raise SystemExit(alone(__file__, measure))
