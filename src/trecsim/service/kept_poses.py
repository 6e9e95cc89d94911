"""The 2D poses of the last minute, for a repair of the rig."""

from collections import deque
from itertools import chain
from threading import Lock

from trecsim.geometry import Rig
from trecsim.values import Poses2D

KEPT_S = 60.0
SPACING_S = 0.07  # about 12 images a second of each camera are enough


class KeptPoses:
    """A sink that keeps images in which somebody is, thinned, for a while.

    Parameters
    ----------
    rig
        The cameras, for the time of their clocks.
    """

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self._kept: dict[str, deque[tuple[float, Poses2D]]] = {name: deque() for name in rig.names}
        self._last_s = dict.fromkeys(rig.names, -float("inf"))
        self._lock = Lock()

    def write(self, poses: Poses2D, /) -> None:
        """Take one more image."""
        if poses.camera not in self._last_s or not len(poses.xy_px):
            return
        time_s = self._rig[poses.camera].time_s(poses.t_s)
        if 0.0 <= time_s - self._last_s[poses.camera] < SPACING_S:
            return
        self._last_s[poses.camera] = time_s
        with self._lock:
            kept = self._kept[poses.camera]  # a clock that is wrong costs only its camera
            while kept and not 0.0 <= time_s - kept[0][0] <= KEPT_S:
                kept.popleft()
            kept.append((time_s, poses))

    def since(self, t_s: float) -> list[Poses2D]:
        """Return what came since a time [s]."""
        with self._lock:
            kept = [one for one in chain(*self._kept.values()) if one[0] >= t_s]
        return [poses for _, poses in sorted(kept, key=lambda one: one[0])]

    def seconds_of_people(self, camera: str, t_s: float) -> float:
        """Return for how long since a time a camera and another one saw somebody [s]."""
        with self._lock:
            of_camera = [
                (time_s, one.camera) for time_s, one in chain(*self._kept.values()) if time_s >= t_s
            ]
        own = {int(time_s / 0.5) for time_s, name in of_camera if name == camera}
        others = {int(time_s / 0.5) for time_s, name in of_camera if name != camera}
        return 0.5 * len(own & others)
