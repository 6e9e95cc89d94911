"""2D poses of a recording as arrays, one camera after the other, undistorted."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.people.tuning import LEAST_SCORE
from trecsim.geometry import Camera, Rig
from trecsim.values import Poses2D

JOINTS = 17


@dataclass(frozen=True, slots=True, eq=False)
class CameraRecord:
    """What one camera saw.

    Attributes
    ----------
    name
        Of the camera.
    t_s
        Stamp of each image, increasing [s].
    first
        Of each image, the number of its first detection; one more entry than images.
    xy
        Key points in the plane z = 1 of the camera, without distortion; NaN where missing.
    size
        Extent of each body in that plane.
    focal_px
        Mean focal length [px].
    """

    name: str
    t_s: Float64[np.ndarray, " image"]
    first: Int64[np.ndarray, " image_1"]
    xy: Float64[np.ndarray, "detection 17 2"]
    size: Float64[np.ndarray, " detection"]
    focal_px: float

    @property
    def image(self) -> Int64[np.ndarray, " detection"]:
        """The image of each detection."""
        return np.repeat(np.arange(len(self.t_s)), np.diff(self.first))


def records(poses: Iterable[Poses2D], rig: Rig) -> tuple[CameraRecord, ...]:
    """Return what each camera of the rig saw, in the order of its stamps."""
    images: dict[str, list[Poses2D]] = {camera.name: [] for camera in rig}
    for one in poses:
        images[one.camera].append(one)
    return tuple(record(camera, images[camera.name]) for camera in rig)


def record(camera: Camera, images: Iterable[Poses2D]) -> CameraRecord:
    """Return the images of one camera as arrays."""
    ordered = sorted(images, key=lambda image: image.t_s)
    counts = np.array([len(image.xy_px) for image in ordered], dtype=np.int64)
    raw = np.concatenate([np.zeros((0, JOINTS, 2)), *(image.xy_px for image in ordered)])
    score = np.concatenate([np.zeros((0, JOINTS)), *(image.score for image in ordered)])
    xy = np.where((score >= LEAST_SCORE)[:, :, None], normalised(camera, raw), np.nan)
    with np.errstate(all="ignore"):
        filled = np.where(np.isfinite(xy), xy, -np.inf).max(axis=1)
        lowest = np.where(np.isfinite(xy), xy, np.inf).min(axis=1)
    extent = filled - lowest
    size = np.where(np.isfinite(extent).all(axis=1), np.hypot(*np.nan_to_num(extent).T), np.nan)
    return CameraRecord(
        camera.name,
        np.array([image.t_s for image in ordered], dtype=np.float64),
        np.concatenate(([0], np.cumsum(counts))).astype(np.int64),
        xy,
        size,
        float(0.5 * (camera.K[0, 0] + camera.K[1, 1])),
    )


def normalised(
    camera: Camera, xy_px: Float64[np.ndarray, "*batch 2"]
) -> Float64[np.ndarray, "*batch 2"]:
    """Return raw pixels in the plane z = 1 of the camera, without distortion."""
    (fx, skew, cx), (_, fy, cy), _ = camera.K
    ideal = camera.undistort(xy_px)
    y = (ideal[..., 1] - cy) / fy
    return np.stack(((ideal[..., 0] - cx - skew * y) / fx, y), axis=-1)
