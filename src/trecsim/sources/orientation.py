"""The rotation that makes a video image upright, as cameras store it in the file."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int32, UInt8


@dataclass(frozen=True, slots=True)
class Orientation:
    """Rows and columns exchanged or not, then mirrored or not.

    Attributes
    ----------
    transposed
        Rows become columns.
    flip_x, flip_y
        Then mirrored left to right, top to bottom.
    """

    transposed: bool = False
    flip_x: bool = False
    flip_y: bool = False

    def size(self, size_px: tuple[int, int]) -> tuple[int, int]:
        """Return width and height after turning, or before, for it is the same."""
        return size_px[::-1] if self.transposed else size_px

    def upright(self, image: UInt8[np.ndarray, "h w 3"]) -> UInt8[np.ndarray, "h2 w2 3"]:
        """Return `image` turned."""
        if self.transposed:
            image = image.swapaxes(0, 1)
        rows = slice(None, None, -1 if self.flip_y else 1)
        columns = slice(None, None, -1 if self.flip_x else 1)
        return np.ascontiguousarray(image[rows, columns])


def from_display_matrix(matrix: Int32[np.ndarray, "9"]) -> Orientation:
    """Return the turn nearest to a display matrix ``(a b u, c d v, x y w)`` of a container.

    It takes the coded position (p, q) to the shown one ``(a p + c q + x, b p + d q + y)``.

    Examples
    --------
    A phone held upright, its picture coded lying on its side:

    >>> from_display_matrix(np.array([0, 1, 0, -1, 0, 0, 0, 0, 1], dtype=np.int32))
    Orientation(transposed=True, flip_x=True, flip_y=False)
    """
    a, b, _, c, d, *_ = matrix.tolist()
    if abs(a) + abs(d) >= abs(b) + abs(c):
        return Orientation(False, a < 0, d < 0)
    return Orientation(True, c < 0, b < 0)
