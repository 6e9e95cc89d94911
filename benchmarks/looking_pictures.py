"""Draw which camera was looked at when, and how, within an eighth of the work.

The sample recording (``trecsim sample``), the scene with two people.

Run: ``python benchmarks/looking_pictures.py``
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib

from harness.demo_video import CAMERAS
from harness.machine import ROOT
from harness.options import Options, sample_folder
from trecsim.estimators import load
from trecsim.estimators.looks import Look
from trecsim.estimators.movenet import MoveNet
from trecsim.estimators.pool import open_videos
from trecsim.looking.recorded import estimate_within
from trecsim.values import Frame, Poses2D

matplotlib.use("Agg")

SCENE, SHARE = "MultiPerson", 1 / 8
USUAL, LIGHT, COARSE, TURNED = "#1f5a94", "#7fb2e0", "#c58b1b", "#b3361e"


class Watched:
    """An estimator whose looks are noted."""

    def __init__(self, estimator: MoveNet) -> None:
        self.skeleton, self.usual = estimator.skeleton, estimator.usual
        self.workers, self.image_limit_px = 1, estimator.image_limit_px
        self.taken: list[tuple[str, float, tuple[Look, ...], int]] = []
        self._estimator = estimator

    def __call__(self, frame: Frame) -> Poses2D:
        """Find the people."""
        return self.look(frame, self.usual)

    def look(self, frame: Frame, looks: Sequence[Look]) -> Poses2D:
        """Find the people, and note how."""
        poses = self._estimator.look(frame, looks)
        self.taken.append((frame.camera, frame.t_s, tuple(looks), len(poses.xy_px)))
        return poses


def draw(path: Path) -> None:
    """Draw the picture into a file."""
    from matplotlib import pyplot

    folder = sample_folder(Options()) / SCENE / "videos"
    model = load("movenet", threads=1)
    assert isinstance(model, MoveNet)
    watched = Watched(model)
    files = dict(zip(CAMERAS, sorted(folder.glob("*.mp4")), strict=True))
    for _ in estimate_within(open_videos(files, watched), watched, SHARE):
        pass
    figure, axes = pyplot.subplots(figsize=(9.0, 3.0), constrained_layout=True)
    for camera, t_s, looks, people in watched.taken:
        row = len(CAMERAS) - 1 - CAMERAS.index(camera)
        usual = looks[0].long_side == model.usual[0].long_side
        axes.bar(t_s, 0.62 if usual else 0.4, 0.024, row - 0.3, color=USUAL if usual else LIGHT)
        if any(look.long_side == model.usual[-1].long_side for look in looks[1:]):
            axes.plot(t_s, row - 0.38, "^", color=COARSE, markersize=5)
        if any(look.turns for look in looks):
            axes.plot(t_s, row + 0.4, "D", color=TURNED, markersize=4)
        axes.annotate(str(people), (t_s, row - 0.16), color="white", fontsize=7, ha="center")
    axes.set_yticks(range(len(CAMERAS)), CAMERAS[::-1])
    axes.set_xlabel("time [s]")
    axes.set_xlim(-0.05, max(t_s for _, t_s, *_ in watched.taken) + 0.05)
    axes.set_ylim(-0.7, len(CAMERAS) - 0.3)
    marks = [
        axes.bar(0, 0, color=USUAL), axes.bar(0, 0, color=LIGHT),
        *axes.plot([], [], "^", color=COARSE), *axes.plot([], [], "D", color=TURNED),
    ]  # fmt: skip
    names = ["usual look (512 px)", "light look (384 px)", "also coarse", "also turned"]
    axes.legend(marks, names, ncols=4, loc="upper center", bbox_to_anchor=(0.5, 1.2), frameon=False)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    matplotlib.rcParams["svg.hashsalt"] = "trecsim"  # else the same picture has other bytes
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def main() -> int:
    """Draw it where it is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    default = ROOT / "docs" / "pictures" / "looking.svg"
    parser.add_argument("--out", type=Path, default=default, help="the file")
    out = parser.parse_args().out
    draw(out)
    print(out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
