"""Privacy masks: parts of a camera's images that are blanked before anything looks at them."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float64, UInt8

Image = UInt8[np.ndarray, "h w 3"]
Polygon = Sequence[Sequence[float]]


class Mask:
    """Blanks polygons of the images of one camera, whatever size these come at.

    Parameters
    ----------
    polygons_px
        Corners in the image as the camera takes it, x and y each [px].
    size_px
        Width and height of that image [px].

    Examples
    --------
    >>> mask = Mask([[(0, 0), (2, 0), (2, 1), (0, 1)]], (4, 2))
    >>> mask(np.full((2, 4, 3), 9, np.uint8))[..., 0].tolist()
    [[0, 0, 9, 9], [9, 9, 9, 9]]
    """

    def __init__(self, polygons_px: Sequence[Polygon], size_px: tuple[int, int]) -> None:
        self._polygons_px = [np.array(polygon, np.float64) for polygon in polygons_px]
        self._size_px = size_px
        self._blank: Bool[np.ndarray, "h w"] = np.zeros((0, 0), np.bool_)

    def __call__(self, image: Image) -> Image:
        """Return the image with the polygons black."""
        height, width = image.shape[:2]
        blank = self._blank  # read once: another thread may make one for another size
        if blank.shape != (height, width):
            scale = np.array([width, height]) / self._size_px
            blank = np.zeros((height, width), np.bool_)
            for corners in self._polygons_px:
                # Corners are places between pixels here: the image begins at 0, not at -0.5.
                blank |= _inside(corners * scale, width, height)
            self._blank = blank
        return np.where(blank[..., None], np.uint8(0), image)


def _inside(
    corners: Float64[np.ndarray, "corner 2"], width: int, height: int
) -> Bool[np.ndarray, "h w"]:
    """Return which pixels' middles are inside a polygon, by the even-odd rule."""
    x = np.arange(width)[None, :] + 0.5
    y = np.arange(height)[:, None] + 0.5
    inside = np.zeros((height, width), np.bool_)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        crosses = (y0 > y) != (y1 > y)
        inside ^= crosses & (x < x0 + (x1 - x0) * (y - y0) / (y1 - y0))
    return inside
