"""Where key points lie relative to the image that the rig states."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from trecsim.consistency.thresholds import Thresholds
from trecsim.consistency.wording import cameras
from trecsim.geometry import Rig
from trecsim.values import Poses2D


@dataclass(slots=True)
class Extent:
    """Where the key points of one camera lie.

    Attributes
    ----------
    points, outside, corner
        How many key points there were, how many of them outside of the image, and how many within
        a few pixels of its corner.
    reach_px
        Width and height that hold nearly all of them [px].
    """

    points: int = 0
    outside: int = 0
    corner: int = 0
    reach_px: Float64[np.ndarray, " 2"] = field(default_factory=lambda: np.zeros(2))

    def add(
        self, xy_px: Float64[np.ndarray, "point 2"], size_px: tuple[int, int], limit: Thresholds
    ) -> None:
        """Count key points; NaN is none."""
        xy_px = xy_px[np.isfinite(xy_px).all(axis=-1)]
        if not len(xy_px):
            return
        share = xy_px / size_px
        margin = limit.outside_margin
        self.points += len(xy_px)
        self.outside += int(((share < -margin) | (share > 1 + margin)).any(axis=-1).sum())
        self.corner += int((np.abs(xy_px) <= limit.corner_px).all(axis=-1).sum())
        self.reach_px = np.maximum(self.reach_px, np.quantile(xy_px, 0.98, axis=0))


def measure(
    extents: Mapping[str, Extent], views: Iterable[Poses2D], rig: Rig, limit: Thresholds
) -> None:
    """Add the key points of images to the extents of their cameras."""
    by_camera: dict[str, list[Float64[np.ndarray, "point 2"]]] = {}
    for view in views:
        if len(view.xy_px):
            by_camera.setdefault(view.camera, []).append(view.xy_px.reshape(-1, 2))
    for name, points in by_camera.items():
        extents[name].add(np.concatenate(points), rig[name].size_px, limit)


def no_pixels(extents: Mapping[str, Extent], rig: Rig, limit: Thresholds) -> dict[str, str]:
    """Return what to say of cameras whose key points cannot be pixels of their image, by cause."""
    known = {name: e for name, e in extents.items() if e.points >= limit.fewest_points}
    corner = [name for name, e in known.items() if e.corner >= limit.corner_share * e.points]
    outside = [name for name, e in known.items() if e.outside >= limit.outside_share * e.points]
    said = {}
    if corner:
        said["corner"] = (
            f"the key points of {cameras(corner, len(rig))} all lie within {limit.corner_px:g} px "
            "of the image's corner: they seem to be given in 0 to 1; multiply them by the width "
            "and height of the image"
        )
    if outside:
        said["outside"] = _outside(outside, known, rig)
    return said


def _outside(names: list[str], extents: Mapping[str, Extent], rig: Rig) -> str:
    worst = max(names, key=lambda name: extents[name].outside / extents[name].points)
    found, (width, height) = extents[worst], rig[worst].size_px
    x, y = found.reach_px
    return (
        f"{found.outside / found.points:.0%} of the key points of camera {worst!r} lie outside of "
        f"its image of {width} x {height} pixels, as far as ({x:.0f}, {y:.0f})"
        + (f", and so it is with {cameras(names, len(rig))}" if len(names) > 1 else "")
        + ": rig and key points seem to be of different image sizes; use the rig calibrated for "
        "the images in which people were found, or scale the key points"
    )
