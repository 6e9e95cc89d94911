"""Draw the picture of how a calibration board is held, with the corners that are found in it.

Run: ``python benchmarks/board_views.py``
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from harness.machine import ROOT

OUT = ROOT / "docs" / "pictures" / "board-views.png"
SIZE_PX = (560, 315)
VIEWS = (  # where the middle of the board is before the camera [m], and how it is tilted [degrees]
    ("fills the image", (0.0, 0.0, 0.95), (0.0, 0.0)),
    ("in a corner", (-0.42, -0.2, 1.2), (0.0, 0.0)),
    ("in the opposite corner", (0.42, 0.2, 1.2), (0.0, 0.0)),
    ("tilted to the side", (0.0, 0.0, 1.1), (0.0, 40.0)),
    ("tilted back", (0.0, 0.0, 1.1), (-40.0, 0.0)),
    ("farther away", (0.15, 0.05, 2.0), (15.0, -25.0)),
)


def draw(out: Path) -> None:
    """Draw the picture into a file."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    from trecsim.calibrating.boards import Board
    from trecsim.calibrating.corners import BoardFinder
    from trecsim.geometry import Camera
    from trecsim.geometry.rigid import rigid_motion, rotation_matrix
    from trecsim.lab.simulation.board_pictures import picture, printed

    focal = 0.85 * SIZE_PX[0]
    K = np.array([[focal, 0.0, SIZE_PX[0] / 2], [0.0, focal, SIZE_PX[1] / 2], [0.0, 0.0, 1.0]])
    camera = Camera("camera", SIZE_PX, K, np.eye(4), "brown", np.array([-0.12, 0.03, 0, 0, 0]))
    board = Board(7, 5, 0.075, "4x4_50")
    paper, finder, rng = printed(board), BoardFinder(board), np.random.default_rng(0)
    figure, axes = pyplot.subplots(2, 3, figsize=(9.0, 3.9), layout="constrained")
    for (name, middle, tilt), one in zip(VIEWS, axes.flat, strict=True):
        R = rotation_matrix(np.deg2rad(np.array([*tilt, 0.0])))
        T = rigid_motion(R, np.array(middle) - R @ board.points_m.mean(axis=0))
        grey = picture(camera, paper, T, rng)
        seen = finder.find(grey)
        one.imshow(grey, cmap="gray", vmin=0, vmax=255)
        count = 0 if seen is None else len(seen)
        if seen is not None:
            one.plot(*seen.xy_px.T, "o", mfc="none", mec="#3fcb5f", ms=4, mew=0.9)
        one.set_title(f"{name}: {count} corners", fontsize=9)
        one.set(xticks=[], yticks=[])
    figure.savefig(out, dpi=100)


def main() -> int:
    """Draw the picture where it is asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--out", type=Path, default=OUT, help="the picture")
    asked = parser.parse_args()
    draw(asked.out)
    print(asked.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
