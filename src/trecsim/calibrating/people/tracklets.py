"""Tracklets: the detections of one person in consecutive images of one camera."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.kernels.tracklet_linking import link
from trecsim.calibrating.people.tuning import SHORTEST_TRACKLET_S


@dataclass(frozen=True, slots=True, eq=False)
class Tracklet:
    """One person for a while, in one camera.

    Attributes
    ----------
    camera
        Number of the camera.
    detections
        Numbers of the detections in the camera's record, in order of time.
    t_s
        Their stamps [s].
    """

    camera: int
    detections: Int64[np.ndarray, " detection"]
    t_s: Float64[np.ndarray, " detection"]


def tracklets(record: CameraRecord, camera: int) -> list[Tracklet]:
    """Return the tracklets of a camera that are long enough to tell something."""
    number = np.full(len(record.xy), -1, dtype=np.int64)
    if not len(number):
        return []
    made = link(record.t_s, record.first, record.xy, record.size, number)
    order = np.argsort(number, kind="stable")
    starts = np.searchsorted(number[order], np.arange(made + 1))
    t_s = record.t_s[record.image]
    found = []
    for k in range(made):
        own = order[starts[k] : starts[k + 1]]
        if len(own) > 2 and t_s[own[-1]] - t_s[own[0]] >= SHORTEST_TRACKLET_S:
            found.append(Tracklet(camera, own, t_s[own]))
    return found
