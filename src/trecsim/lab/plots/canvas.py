"""An empty picture of the floor, seen from above, and how pictures are written."""

import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from trecsim.errors import InputError
from trecsim.extras import needed
from trecsim.store.atomic import atomic_write

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg", ".pdf", ".jpg")
DOTS_PER_INCH = 150
LINES_WANTED = 14  # of the grid, along the longer side
FINEST_STEP_M = 0.5


def empty_figure(width_in: float, height_in: float) -> "Figure":
    """Return an empty picture.

    Raises
    ------
    SetupError
        Matplotlib is not installed.
    """
    needed("pictures need Matplotlib", "plot", "matplotlib", "matplotlib.figure")
    from matplotlib.figure import Figure

    return Figure(figsize=(width_in, height_in), layout="constrained")


def floor_figure(x_m: tuple[float, float], y_m: tuple[float, float]) -> "tuple[Figure, Axes]":
    """Return a picture of a part of the floor from above, in equal metres, with a grid.

    Raises
    ------
    SetupError
        Matplotlib is not installed.
    """
    width, height = x_m[1] - x_m[0], y_m[1] - y_m[0]
    longest = max(width, height)
    figure = empty_figure(1.5 + 7.5 * width / longest, 1.5 + 7.5 * height / longest)
    axes = figure.add_subplot()
    lay_floor(axes, x_m, y_m)
    return figure, axes


def lay_floor(axes: "Axes", x_m: tuple[float, float], y_m: tuple[float, float]) -> None:
    """Make axes a part of the floor from above, in equal metres, with a grid."""
    from matplotlib.ticker import MultipleLocator

    axes.set(xlim=x_m, ylim=y_m, aspect="equal", xlabel="x [m]", ylabel="y [m]")
    step_m = round_step(max(x_m[1] - x_m[0], y_m[1] - y_m[0]) / LINES_WANTED, FINEST_STEP_M)
    axes.xaxis.set_major_locator(MultipleLocator(step_m))
    axes.yaxis.set_major_locator(MultipleLocator(step_m))
    axes.grid(color="0.88", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(length=0, labelcolor="0.35")
    for spine in axes.spines.values():
        spine.set_color("0.7")


def round_step(least: float, finest: float) -> float:
    """Return the smallest of 1, 2, 5, 10, 20, ... that is not less, or the finest allowed.

    Examples
    --------
    >>> round_step(3.0, 0.5), round_step(0.1, 0.5), round_step(200.0, 0.5)
    (5.0, 0.5, 200.0)
    """
    if least <= finest:
        return finest
    decade = 10.0 ** math.floor(math.log10(least))
    return next(factor * decade for factor in (1, 2, 5, 10) if factor * decade >= least * 0.999)


@contextmanager
def missing_glyphs_allowed() -> Iterator[None]:
    """Draw letters that the font does not have as boxes, without a warning for each."""
    with warnings.catch_warnings():
        warnings.filterwarnings(
            "ignore", message="Glyph .* missing from font", category=UserWarning
        )
        yield


def save_figure(figure: "Figure", path: Path) -> None:
    """Write a picture, whole or not at all; the suffix of the name is its format.

    Raises
    ------
    InputError
        The suffix is not that of a picture.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(
            f"cannot write a picture to {path}: expected a name that ends in "
            f"{', '.join(SUFFIXES)}, got {suffix or 'no suffix'!r}"
        )
    with missing_glyphs_allowed(), atomic_write(path, "wb") as file:
        figure.savefig(file, format=suffix[1:], dpi=DOTS_PER_INCH, facecolor="white")
