"""What all pictures of the model have in common: paper, colours, bodies, and how they are kept."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float64

from trecsim.skeleton import COCO17

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BLUE, ORANGE, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
GREY, TRUTH = "0.45", "0.1"
STYLE: dict[str, Any] = {
    "svg.hashsalt": "trecsim",  # else the same picture would have other bytes every time
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.edgecolor": "0.6",
    "axes.labelcolor": "0.2",
    "xtick.color": "0.35",
    "ytick.color": "0.35",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "0.92",
    "grid.linewidth": 0.7,
    "legend.frameon": False,
    "legend.fontsize": 8,
}
_PLACES = re.compile(r' (?:d|x|y|x1|y1|x2|y2)="[^"]*"')
_NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")


@contextmanager
def sheet(path: Path, width_in: float, height_in: float) -> "Iterator[Figure]":
    """Give an empty picture, and write it when the block ends.

    Parameters
    ----------
    path
        Of the picture; the same drawing gives the same bytes.
    width_in, height_in
        Its size [inches].
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(width_in, height_in), layout="constrained")
        yield figure
        if path.suffix != ".svg":
            figure.savefig(path, dpi=110, facecolor="white")
            return
        drawn = StringIO()
        figure.savefig(drawn, format="svg", metadata={"Date": None}, facecolor="white")
        path.write_text(rounded(drawn.getvalue()), encoding="utf-8")


def rounded(svg: str) -> str:
    """Return a drawing with its points to a hundredth: smaller, and the same on other machines."""
    return _PLACES.sub(lambda places: _NUMBER.sub(_short, places[0]), svg)


def _short(number: re.Match[str]) -> str:
    return f"{round(float(number[0]), 2) + 0.0:g}"  # no -0


def letter(axes: "Axes", name: str, title: str) -> None:
    """Write a panel's letter and what it is about."""
    axes.set_title(f"$\\bf{{{name}}}$  {title}")


def draw_body(axes: "Axes", points: Float64[np.ndarray, "joint axis"], **style: Any) -> None:
    """Draw the limbs of one person, in an image or from the side; the face is a point."""
    style = {"linewidth": 1.6, "solid_capstyle": "round", **style}
    for first, second in COCO17.limbs:
        ends = points[[first, second]]
        if first > 4 and np.isfinite(ends).all():
            axes.plot(*ends.T, **style)
    head = points[:5][np.isfinite(points[:5, 0])]
    if len(head):
        mark = {name: value for name, value in style.items() if name in ("color", "alpha")}
        axes.plot(*head.mean(axis=0), "o", markersize=5, markeredgewidth=0, **mark)
