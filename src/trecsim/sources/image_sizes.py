"""Sizes of images: as a camera takes them, and smaller, as an estimator looks at them."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from trecsim.values import LOOK_DIGITS, Poses2D

LACKING = 0.02  # of rows or columns may be missing, as some encoders cut them


def fitted(size_px: tuple[int, int], limit_px: tuple[int, int]) -> tuple[int, int]:
    """Return the size that an image has to have to fit into a limit; never a larger one.

    Parameters
    ----------
    size_px, limit_px
        Width and height [px].

    Examples
    --------
    >>> fitted((1920, 1080), (480, 480)), fitted((320, 240), (480, 480))
    ((480, 270), (320, 240))
    """
    scale = min(1.0, limit_px[0] / size_px[0], limit_px[1] / size_px[1])
    return max(1, round(size_px[0] * scale)), max(1, round(size_px[1] * scale))


def is_cut(found_px: tuple[int, int], expected_px: tuple[int, int]) -> bool:
    """Return whether images only lack a few rows or columns, as after some encoders.

    Parameters
    ----------
    found_px, expected_px
        Width and height [px].

    Examples
    --------
    >>> is_cut((1920, 1072), (1920, 1080)), is_cut((1280, 720), (1920, 1080))
    (True, False)
    """
    return all((1.0 - LACKING) * e <= f <= e for f, e in zip(found_px, expected_px, strict=True))


def original_px(
    xy_px: Float64[np.ndarray, "*batch 2"],
    size_px: tuple[int, int],
    original_size_px: tuple[int, int],
) -> Float64[np.ndarray, "*batch 2"]:
    """Return the positions in the original image of points in a smaller one [px].

    Pixel centres are at integers, so it is the borders of the images that coincide, at -0.5.

    Parameters
    ----------
    xy_px
        The points [px].
    size_px, original_size_px
        Width and height of both images [px].
    """
    scale = np.array(original_size_px) / np.array(size_px)
    original: Float64[np.ndarray, "*batch 2"] = (xy_px + 0.5) * scale - 0.5
    return original


def in_original(
    poses: Poses2D, size_px: tuple[int, int], original_size_px: tuple[int, int]
) -> Poses2D:
    """Return poses that were found in a smaller image in pixels of the original one.

    Parameters
    ----------
    poses
        As the estimator found them.
    size_px, original_size_px
        Width and height of both images [px].
    """
    if size_px == original_size_px:
        return poses
    return replace(
        poses,
        xy_px=original_px(poses.xy_px, size_px, original_size_px),
        pixel_px=(poses.pixel_px * (max(original_size_px) / max(size_px))).round(LOOK_DIGITS),
    )
