"""Whose key points are whose in one camera's images: a tracker in 2D that knows nothing of 3D."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from trecsim.values import Poses2D

LEAST_SCORE = 0.3
LEAST_JOINTS = 5  # that two images have in common, to measure how far a person moved
MOST_MOVED = 0.25  # from one image to the next, as a share of the person's height in the image

Points = npt.NDArray[np.float64]
Labels = dict[str, Points]
"""By actor, key points in each frame: x and y [px] and score, NaN where there is none."""


@dataclass(slots=True)
class _Track:
    """A person as last detected: each key point from the last image that shows it well."""

    xy_px: Points
    height_px: float

    def distance(self, xy_px: Points, score: Points) -> float:
        """Return how far a detection is from here, by the person's height."""
        off_px = np.linalg.norm(xy_px - self.xy_px, axis=-1)[score >= LEAST_SCORE]
        off_px = off_px[np.isfinite(off_px)]
        if len(off_px) < LEAST_JOINTS:
            return np.inf
        return float(np.median(off_px)) / self.height_px

    def take(self, xy_px: Points, score: Points) -> None:
        """Move on to a detection."""
        good = (score >= LEAST_SCORE) & np.isfinite(xy_px).all(axis=-1)
        self.xy_px[good] = xy_px[good]


def followed_in_2d(
    images: Sequence["Poses2D"], first_px: Mapping[str, tuple[float, float]]
) -> Labels:
    """Follow people through the images of one camera.

    Parameters
    ----------
    images
        In order of time.
    first_px
        Where the middle of each person's key points is in the first image [px].
    """
    from scipy.optimize import linear_sum_assignment

    first = images[0]
    found: Labels = {
        who: np.full((len(images), first.xy_px.shape[1], 3), np.nan) for who in first_px
    }
    tracks = {who: _begin(first, middle) for who, middle in first_px.items()}
    for frame, image in enumerate(images):
        if not len(image.score):
            continue
        apart = np.array(
            [
                [
                    track.distance(xy, score)
                    for xy, score in zip(image.xy_px, image.score, strict=True)
                ]
                for track in tracks.values()
            ]
        )
        rows, columns = linear_sum_assignment(np.minimum(apart, 1e3))
        names = list(tracks)
        for row, column in zip(rows, columns, strict=True):
            if apart[row, column] <= MOST_MOVED:
                xy_px, score = image.xy_px[column], image.score[column]
                tracks[names[row]].take(xy_px, score)
                found[names[row]][frame] = np.column_stack([xy_px, score])
    return found


def _begin(image: "Poses2D", middle_px: tuple[float, float]) -> _Track:
    shown = np.where((image.score >= LEAST_SCORE)[..., None], image.xy_px, np.nan)
    nearest = int(np.argmin(np.linalg.norm(np.nanmedian(shown, axis=1) - middle_px, axis=-1)))
    xy_px = shown[nearest]
    return _Track(xy_px.copy(), float(np.ptp(xy_px[np.isfinite(xy_px[:, 1]), 1])))
