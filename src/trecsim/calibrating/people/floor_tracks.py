"""Where people walk, as one camera sees it: floor positions on a grid of its own clock."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.tracklets import Tracklet
from trecsim.calibrating.people.tuning import (
    ANKLE,
    HEIGHT_OF_JOINT,
    LONGEST_GAP_S,
    SMOOTH_TICKS,
    STATURE_M,
    TICK_S,
)

PARTS = ((15, 16), (11, 12), (5, 6))  # ankles, hips, shoulders: the first that is there
STEEPEST = 0.05  # a ray nearer to the horizon tells no place on the floor


@dataclass(frozen=True, slots=True, eq=False)
class FloorTracks:
    """The ways of all tracklets of one camera.

    Attributes
    ----------
    first
        Of each tracklet the number of its first position; one more entry than tracklets.
    tick
        Of each tracklet the time of its first position, in units of `TICK_S`.
    xy_m
        Positions on the floor, one per tick [m].
    """

    first: Int64[np.ndarray, " tracklet_1"]
    tick: Int64[np.ndarray, " tracklet"]
    xy_m: Float64[np.ndarray, "position 2"]


def floor_tracks(
    record: CameraRecord, tracks: list[Tracklet], T_world_cam: Float64[np.ndarray, "4 4"]
) -> FloorTracks:
    """Return where people walk, in the frame to which `T_world_cam` leads; the ankles at z = 0."""
    places = floor_positions(record.xy, T_world_cam)
    ticks, pieces = [], []
    for track in tracks:
        tick, piece = on_grid(track.t_s, places[track.detections])
        ticks.append(tick)
        pieces.append(piece)
    first = np.concatenate(([0], np.cumsum([len(piece) for piece in pieces], dtype=np.int64)))
    return FloorTracks(
        first.astype(np.int64),
        np.array(ticks, dtype=np.int64),
        np.concatenate([np.zeros((0, 2)), *pieces]),
    )


def floor_positions(
    xy: Float64[np.ndarray, "detection 17 2"], T_world_cam: Float64[np.ndarray, "4 4"]
) -> Float64[np.ndarray, "detection 2"]:
    """Return where each detection stands [m]: below its ankles, or hips, or shoulders."""
    centre = T_world_cam[:3, 3]
    found = np.full((len(xy), 2), np.nan)
    for pair in PARTS:
        middle = xy[:, pair].mean(axis=1)
        rays = np.column_stack((middle, np.ones(len(xy)))) @ T_world_cam[:3, :3].T
        height_m = (HEIGHT_OF_JOINT[pair[0]] - ANKLE) * STATURE_M
        with np.errstate(all="ignore"):
            steep = -rays[:, 2] / np.linalg.norm(rays, axis=1) * np.sign(centre[2] - height_m)
            along = (height_m - centre[2]) / rays[:, 2]
        place = centre[:2] + along[:, None] * rays[:, :2]
        use = np.isnan(found[:, 0]) & (steep > STEEPEST)
        found[use] = place[use]
    return found


def on_grid(
    t_s: Float64[np.ndarray, " time"], xy_m: Float64[np.ndarray, "time 2"]
) -> tuple[int, Float64[np.ndarray, "tick 2"]]:
    """Return the first tick, and positions at all ticks from there on; without outliers."""
    known = np.isfinite(xy_m[:, 0])
    if known.sum() < 2 or np.diff(t_s[known]).max() > 4 * LONGEST_GAP_S:
        return 0, np.zeros((0, 2))
    t_s, xy_m = t_s[known], xy_m[known]
    first, last = int(np.ceil(t_s[0] / TICK_S)), int(np.floor(t_s[-1] / TICK_S))
    at_s = np.arange(first, last + 1) * TICK_S
    piece = np.stack([np.interp(at_s, t_s, xy_m[:, a]) for a in range(2)], axis=1)
    return first, smoothed(piece)


def smoothed(xy_m: Float64[np.ndarray, "tick 2"]) -> Float64[np.ndarray, "tick 2"]:
    """Return the running median."""
    if not len(xy_m):
        return xy_m
    padded = np.pad(xy_m, ((SMOOTH_TICKS, SMOOTH_TICKS), (0, 0)), constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * SMOOTH_TICKS + 1, axis=0)
    middle: Float64[np.ndarray, "tick 2"] = np.nanmedian(windows, axis=-1)
    return middle
