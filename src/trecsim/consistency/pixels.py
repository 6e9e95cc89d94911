"""Where key points lie relative to the image that the rig states."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from trecsim.consistency.thresholds import Thresholds
from trecsim.consistency.verdict import Verdict
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
        Width and height that hold nearly all of them, where some are outside [px].
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
        outside = int(((share < -margin) | (share > 1 + margin)).any(axis=-1).sum())
        self.corner += int((np.abs(xy_px) <= limit.corner_px).all(axis=-1).sum())
        if outside:
            self.outside += outside
            self.reach_px = np.maximum(self.reach_px, np.quantile(xy_px, 0.98, axis=0))


def measure(
    extents: Sequence[Extent], views: Iterable[Poses2D], rig: Rig, limit: Thresholds
) -> None:
    """Add the key points of images to the extents of their cameras."""
    by_camera: dict[str, list[Float64[np.ndarray, "point 2"]]] = {}
    for view in views:
        if len(view.xy_px):
            by_camera.setdefault(view.camera, []).append(view.xy_px.reshape(-1, 2))
    for name, points in by_camera.items():
        extents[rig.index(name)].add(np.concatenate(points), rig[name].size_px, limit)


def no_pixels(extents: Sequence[Extent], rig: Rig, limit: Thresholds) -> list[Verdict]:
    """Return what to say of cameras whose key points cannot be pixels of their image."""
    known = {c: e for c, e in enumerate(extents) if e.points >= limit.fewest_points}
    corner = [c for c, e in known.items() if e.corner >= limit.corner_share * e.points]
    outside = [c for c, e in known.items() if e.outside >= limit.outside_share * e.points]
    said = []
    if corner:
        text = (
            f"the key points of {cameras([rig.names[c] for c in corner], len(rig))} all lie within "
            f"{limit.corner_px:g} px of the image's corner: they seem to be given in 0 to 1; "
            "multiply them by the width and height of the image"
        )
        said.append(Verdict("corner", text, tuple(corner)))
    if outside:
        said.append(Verdict("outside", _outside(outside, known, rig), tuple(outside), sure=False))
    return said


def _outside(which: list[int], extents: Mapping[int, Extent], rig: Rig) -> str:
    worst = max(which, key=lambda c: extents[c].outside / extents[c].points)
    found, (width, height) = extents[worst], rig.cameras[worst].size_px
    x, y = found.reach_px
    names = [rig.names[c] for c in which]
    return (
        f"{found.outside / found.points:.0%} of the key points of camera {rig.names[worst]!r} lie "
        f"outside of its image of {width} x {height} pixels, as far as ({x:.0f}, {y:.0f})"
        + (f", and so it is with {cameras(names, len(rig))}" if len(names) > 1 else "")
        + ": rig and key points seem to be of different image sizes; use the rig calibrated for "
        "the images in which people were found, or scale the key points"
    )
