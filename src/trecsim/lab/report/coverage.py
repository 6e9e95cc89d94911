"""What the cameras of a rig see of the floor and of the people, in numbers."""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.geometry import Rig
from trecsim.geometry.view import image_margin
from trecsim.lab.evaluation.person_tracks import people_of
from trecsim.lab.evaluation.reprojection import Reprojection, reprojection
from trecsim.lab.plots.path_recorder import floor_places
from trecsim.lab.report.plan_section import Extent, extent_of
from trecsim.lab.report.recording import Recording
from trecsim.sources import read_poses
from trecsim.values import Poses2D

MOST_JUDGED = 4000  # person-frames that are projected into all images
MOST_WINDOWS = 3000  # pieces of time in which key points are compared with the tracks
CELLS = 160  # of the floor, along the longer side
WALKED_M = 0.5  # distance to a person up to which the floor counts
MOST_COUNTED = 4  # this many cameras and more are one class


@dataclass(frozen=True, slots=True, eq=False)
class CameraFacts:
    """What the cameras see, and how the tracks agree with what was found in their images.

    Attributes
    ----------
    rig
        The cameras.
    extent
        The part of the floor that is shown.
    x_m, y_m
        Middles of its cells [m].
    margin
        How far inside the image of each camera each cell is, as a share of its width; negative
        outside.
    walked
        The cells near which a person was.
    in_view
        Share of the person-frames in which a camera has most of the person in its image.
    by_count
        Share of the person-frames with none, one, ... four or more cameras in view.
    supported
        The same for the cameras that in fact support a joint, over all joints.
    found
        How tracks and key points agree; None without 2D poses.
    images
        How many images each camera delivered; empty without 2D poses.
    """

    rig: Rig
    extent: Extent
    x_m: Float64[np.ndarray, " x"]
    y_m: Float64[np.ndarray, " y"]
    margin: Float64[np.ndarray, "cam y x"]
    walked: Bool[np.ndarray, "y x"]
    in_view: Float64[np.ndarray, " cam"]
    by_count: Float64[np.ndarray, "5"]
    supported: Float64[np.ndarray, "5"]
    found: Reprojection | None
    images: dict[str, int]

    @property
    def sees(self) -> Bool[np.ndarray, "cam y x"]:
        """Which camera sees which cell of the floor."""
        return self.margin > 0


def facts_of(recording: Recording) -> CameraFacts | None:
    """Return coverage, support and errors of the cameras; None without a rig or people.

    Raises
    ------
    InputError
        The 2D poses are not right, or come from cameras that the rig does not have.
    """
    sample, rig = recording.sample, recording.rig
    if rig is None or not len(sample.id):
        return None
    places_m = floor_places(sample.xyz_m)
    extent = extent_of(places_m, rig)
    cells_m = _cells(extent)
    inside = _in_view(rig, recording)
    images: Counter[str] = Counter()
    found = None
    if recording.places.poses is not None:
        poses = read_poses(recording.places.poses, rig_cameras=rig.names)
        some = _within(_counted(poses, images), rig, recording)
        found = reprojection(some, rig, people_of(sample), recording.period_s)
    return CameraFacts(
        rig=rig,
        extent=extent,
        x_m=cells_m[0, :, 0],
        y_m=cells_m[:, 0, 1],
        margin=np.stack([image_margin(camera, cells_m) for camera in rig]),
        walked=_walked(cells_m, places_m),
        in_view=inside.mean(axis=1),
        by_count=_shares(inside.sum(axis=0)),
        supported=_shares(sample.support[np.isfinite(sample.xyz_m[..., 0])]),
        found=found,
        images=dict(images),
    )


def _cells(extent: Extent) -> Float64[np.ndarray, "y x 3"]:
    """Return the middles of the cells of the floor."""
    cell_m = max(extent.width_m, extent.depth_m) / CELLS
    x_m = np.arange(extent.x_m[0], extent.x_m[1] + cell_m, cell_m)
    y_m = np.arange(extent.y_m[0], extent.y_m[1] + cell_m, cell_m)
    cells_m = np.zeros((len(y_m), len(x_m), 3))
    cells_m[..., 0], cells_m[..., 1] = np.meshgrid(x_m, y_m)
    return cells_m


def _walked(
    cells_m: Float64[np.ndarray, "y x 3"], places_m: Float64[np.ndarray, "row 2"]
) -> Bool[np.ndarray, "y x"]:
    """Return the cells near which a person was."""
    rows, columns = cells_m.shape[:2]
    cell_m = float(cells_m[0, 1, 0] - cells_m[0, 0, 0])
    known_m = places_m[np.isfinite(places_m).all(axis=1)]
    at = np.floor((known_m - cells_m[0, 0, :2]) / cell_m + 0.5).astype(np.int64)
    at = np.unique(at[((at >= 0) & (at < [columns, rows])).all(axis=1)], axis=0)
    walked = np.zeros((rows, columns), np.bool_)
    reach = round(WALKED_M / cell_m)
    for down in range(-reach, reach + 1):
        for right in range(-reach, reach + 1):
            if down**2 + right**2 <= reach**2:
                y, x = at[:, 1] + down, at[:, 0] + right
                fits = (y >= 0) & (y < rows) & (x >= 0) & (x < columns)
                walked[y[fits], x[fits]] = True
    return walked


def _in_view(rig: Rig, recording: Recording) -> Bool[np.ndarray, "cam row"]:
    """Return which camera has most known joints of each sampled person-frame in its image."""
    xyz_m = recording.sample.xyz_m
    xyz_m = xyz_m[:: max(len(xyz_m) // MOST_JUDGED, 1)].astype(np.float64)
    known = np.isfinite(xyz_m[..., 0]).sum(axis=1)
    return np.stack([(image_margin(camera, xyz_m) > 0).sum(axis=1) > known / 2 for camera in rig])


def _shares(
    cameras: "np.ndarray[tuple[int, ...], np.dtype[np.integer]]",
) -> Float64[np.ndarray, "5"]:
    counts = np.bincount(np.minimum(cameras, MOST_COUNTED), minlength=MOST_COUNTED + 1)
    return np.asarray(counts / max(counts.sum(), 1))


def _counted(poses: Iterable[Poses2D], images: Counter[str]) -> Iterator[Poses2D]:
    for image in poses:
        images[image.camera] += 1
        yield image


def _within(poses: Iterable[Poses2D], rig: Rig, recording: Recording) -> Iterator[Poses2D]:
    """Yield the images taken between two consecutive frames of the sample."""
    t_s = recording.sample.t_s
    starts = np.flatnonzero(np.diff(t_s) <= 1.5 * recording.period_s)
    starts = starts[:: max(len(starts) // MOST_WINDOWS, 1)]
    begin_s, end_s = t_s[starts] - 2e-6, t_s[np.minimum(starts + 1, len(t_s) - 1)] + 2e-6
    cameras = {camera.name: camera for camera in rig}
    for image in poses:
        at_s = cameras[image.camera].time_s(image.t_s)
        window = int(np.searchsorted(begin_s, at_s, side="right")) - 1
        if window >= 0 and at_s <= end_s[window]:
            yield image
