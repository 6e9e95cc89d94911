"""2D poses in, people in 3D out: frame sets and the tracker, timed."""

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from trecsim.fusion import FusionSettings, Tracker
from trecsim.fusion.warmup import warm_up
from trecsim.geometry import Rig
from trecsim.sync import frame_sets
from trecsim.types import Poses2D, Snapshot


@dataclass(slots=True)
class Tally:
    """What a tracking run has done so far.

    Attributes
    ----------
    fusion_s
        Time that association and fit took, per frame set [s].
    people
        Every identity reported.
    """

    fusion_s: list[float] = field(default_factory=list)
    people: set[int] = field(default_factory=set)

    @property
    def frame_sets(self) -> int:
        """Number of frame sets."""
        return len(self.fusion_s)

    def fusion_ms(self) -> dict[str, float]:
        """Return median, 95th percentile, maximum and mean of the fusion's time [ms]."""
        if not self.fusion_s:
            return dict.fromkeys(("median", "p95", "max", "mean"), float("nan"))
        ms = 1e3 * np.array(self.fusion_s)
        return {
            "median": float(np.median(ms)),
            "p95": float(np.quantile(ms, 0.95)),
            "max": float(ms.max()),
            "mean": float(ms.mean()),
        }


def follow(
    poses: Iterable[Poses2D],
    rig: Rig,
    settings: FusionSettings | None = None,
    *,
    lag_s: float = 0.0,
    tally: Tally | None = None,
) -> Iterator[Snapshot]:
    """Reconstruct everybody's trajectory from 2D poses.

    Parameters
    ----------
    poses
        Images in order of arrival.
    rig
        The cameras; their time offsets are added to the images' times.
    settings
        Of the fusion.
    lag_s
        How far behind the newest image of a frame set each snapshot is [s].
    tally
        Is kept up to date.

    Yields
    ------
    Snapshot
        One per frame set, at the newest time of the set minus the lag.
    """
    tally = tally if tally is not None else Tally()
    warm_up()
    tracker = Tracker(rig, settings, lag_s=lag_s)
    offsets_s = {camera.name: camera.time_offset_s for camera in rig}
    for frame_set in frame_sets(poses, offsets_s=offsets_s):
        began_s = time.perf_counter()
        snapshot = tracker.step(frame_set)
        tally.fusion_s.append(time.perf_counter() - began_s)
        tally.people.update(snapshot.id.tolist())
        yield snapshot
