"""How people begin where rays meet, after the thesis' figure 16."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64, Int64

from pictured.runs import made, tracked, truth_at
from pictured.sheet import BLUE, GREEN, GREY, ORANGE, TRUTH, draw_body, letter, sheet
from trecsim.fusion import FusionSettings, birth, kernels
from trecsim.fusion.images import Detections, prepare
from trecsim.fusion.model import Model, build
from trecsim.lab.simulation import Simulation
from trecsim.skeleton import COCO17
from trecsim.sync import frame_sets
from trecsim.values import Snapshot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCENE, SECONDS, FROM_S = "three-people", 9.0, 8.0
COLOURS = (BLUE, ORANGE, GREEN)
LETTERS = "abc"
REACH_M = 6.0


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """The first frame set of cameras that are just switched on.

    Attributes
    ----------
    run
        The scene.
    model
        Constants of the run.
    t_s
        When the images were taken [s].
    found
        The detections, which nobody explains.
    ray
        Directions of the rays through their key points.
    score
        How well any two detections are one person.
    born
        Who begins, best first.
    """

    run: Simulation
    model: Model
    t_s: float
    found: Detections
    ray: Float64[np.ndarray, "person joint 3"]
    score: Float64[np.ndarray, "person person"]
    born: tuple[birth.Candidate, ...]

    def of(self, cam: int) -> Int64[np.ndarray, " person"]:
        """Return the detections of a camera, from left to right."""
        mine = np.flatnonzero(self.found.cam == cam)
        return mine[np.argsort(np.nanmean(self.found.xy_px[mine, :, 0], axis=1))]

    def colour(self, detection: int) -> str:
        """Return the colour of whom a detection shows."""
        return next(
            (c for c, one in zip(COLOURS, self.born, strict=True) if detection in one.member), GREY
        )

    def between(self, i: int, k: int) -> float:
        """Return the score of two detections, in whichever order."""
        return float(max(self.score[i, k], self.score[k, i]))


def search() -> Search:
    """Look at the first images with what the tracker uses."""
    run = made(SCENE, SECONDS)
    model = build(run.rig, COCO17, FusionSettings())
    first = next(iter(frame_sets(view for view in run.poses if view.t_s > FROM_S)))
    images = prepare(first.views, model)
    found = images.detections(np.ones(len(images.xy_px), bool))
    ray, origin_m = birth.rays(model, found), model.cameras.position_m[found.cam]
    score = np.full((len(found), len(found)), -np.inf)
    flip = np.zeros(score.shape, np.int64)
    sight = kernels.Rays(found.cam, origin_m, ray, found.sigma_scale, found.t_s)
    kernels.pair_scores(sight, model.bones, model.noise, score, flip)
    born = tuple(birth.candidates(model, found))
    return Search(run, model, first.t_s, found, ray, score, born)


def draw_image(axes: "Axes", seen: Search, cam: int, names: str) -> None:
    """Draw the detections of one camera."""
    for name, d in zip(names, seen.of(cam), strict=True):
        xy_px = seen.found.xy_px[d]
        draw_body(axes, xy_px, color=seen.colour(int(d)))
        side = np.nanmin(xy_px[:, 0]), np.nanmedian(xy_px[:, 1])
        axes.annotate(name, side, (-5, 0), textcoords="offset points", ha="right", weight="bold")
    width, height = seen.model.lenses.size_px[cam]
    axes.set(xlim=(0, width), ylim=(height, 0), aspect="equal", xlabel="column [px]")
    axes.set_ylabel("row [px]")
    axes.spines[:].set_visible(True)
    axes.grid(False)


def draw_scores(axes: "Axes", seen: Search) -> None:
    """Draw how well any two detections are one person."""
    rows, columns = seen.of(0), seen.of(1)
    for y, i in enumerate(rows):
        for x, k in enumerate(columns):
            score = seen.between(int(i), int(k))
            chosen = any({int(i), int(k)} <= set(one.member.tolist()) for one in seen.born)
            text = f"{score:.0f}" if np.isfinite(score) else "—"
            colour = seen.colour(int(i)) if chosen else "0.45"
            box = {"boxstyle": "circle,pad=0.35", "facecolor": "white", "edgecolor": colour}
            axes.text(
                x, y, text, ha="center", va="center", color=colour, fontsize=11,
                weight="bold" if chosen else "normal", bbox=box if chosen else None,
            )  # fmt: skip
    axes.set(xlim=(-0.6, 2.6), ylim=(2.6, -0.6), xlabel="detection of cam2")
    axes.set_xticks(range(3), ["1", "2", "3"])
    axes.set_yticks(range(3), list(LETTERS))
    axes.set_ylabel("detection of cam1")
    axes.grid(False)
    letter(axes, "C", "Log ratios of the pairs")


def draw_floor(axes: "Axes", seen: Search) -> None:
    """Draw rays and people from above."""
    model = seen.model
    for d in range(len(seen.found)):
        origin_m = model.cameras.position_m[seen.found.cam[d]]
        along = np.nanmean(seen.ray[d][model.torso], axis=0)[:2]
        end_m = origin_m[:2] + REACH_M * along / np.linalg.norm(along)
        line = np.stack((origin_m[:2], end_m)).T
        axes.plot(*line, color=seen.colour(d), linewidth=0.8, alpha=0.7)
    for name, at_m in zip(seen.run.rig.names, model.cameras.position_m, strict=True):
        axes.plot(*at_m[:2], "s", color="0.3", markersize=6)
        axes.annotate(name, at_m[:2], (0, -12), textcoords="offset points", ha="center")
    times = np.array([seen.t_s])
    for person in range(len(seen.run.truth_xyz_m)):
        truth_m = truth_at(seen.run, person, times)[0]
        draw_body(axes, truth_m[:, :2], color=TRUTH, linewidth=4.0, alpha=0.3)
    for colour, one in zip(COLOURS, seen.born, strict=True):
        draw_body(axes, one.xyz_m[:, :2], color=colour)
    axes.set(xlim=(-3.2, 1.5), ylim=(-0.5, 4.0), aspect="equal", xlabel="x [m]", ylabel="y [m]")
    letter(axes, "D", "Rays of the torsos, and who is born")


def gaps_cm(seen: Search, i: int, k: int) -> Float64[np.ndarray, " joint"]:
    """Return how far the rays of each joint of two detections pass each other [cm]."""
    at_m, point = seen.model.cameras.position_m[seen.found.cam], np.empty(3)
    return 100 * np.array(
        [
            kernels.ray_midpoint(at_m[i], seen.ray[i, j], at_m[k], seen.ray[k, j], point)
            for j in range(len(COCO17.joints))
        ]
    )


def draw_gaps(axes: "Axes", seen: Search) -> None:
    """Draw the residuals of every pair."""
    names, y = [], 0
    for name, i in zip(LETTERS, seen.of(0), strict=True):
        for number, k in enumerate(seen.of(1), 1):
            gap = gaps_cm(seen, int(i), int(k))
            chosen = seen.colour(int(i)) == seen.colour(int(k))
            colour = seen.colour(int(i)) if chosen else "0.6"
            axes.plot(np.maximum(gap, 0.05), np.full(len(gap), y), "o", color=colour,
                      markersize=3.5, alpha=0.8, markeredgewidth=0)  # fmt: skip
            names.append(f"{name}{number}")
            y += 1
    axes.set(xscale="log", xlim=(0.04, 300), ylim=(y - 0.4, -0.6))
    axes.set_xticks([0.1, 1, 10, 100], ["0.1", "1", "10", "100"])
    axes.set_yticks(range(y), names)
    axes.set_xlabel("gap of a joint's two rays [cm]")
    letter(axes, "E", "Residuals of pairs")


def first_seen_s(snapshots: list[Snapshot]) -> dict[int, float]:
    """Return when each identity was first reported [s]."""
    first: dict[int, float] = {}
    for one in snapshots:
        for person in one.id.tolist():
            first.setdefault(person, one.t_s)
    return first


def draw_times(axes: "Axes", seen: Search) -> None:
    """Draw when each began, and when it was reported."""
    poses = [view for view in seen.run.poses if view.t_s > FROM_S]
    begun = first_seen_s(tracked(seen.run, replace(FusionSettings(), confirm_s=1e-9), poses=poses))
    told = first_seen_s(tracked(seen.run, poses=poses))
    end_s = 0.5
    for row, person in enumerate(sorted(told)):
        colour, since_s, told_s = COLOURS[row], begun[person] - FROM_S, told[person] - FROM_S
        axes.barh(row, told_s - since_s, left=since_s, height=0.5, color=colour, alpha=0.3)
        axes.barh(row, end_s - told_s, left=told_s, height=0.5, color=colour)
    axes.set(xlim=(0, end_s), ylim=(2.6, -0.6), yticks=[], xlabel="time since switched on [s]")
    letter(axes, "F", "On trial (pale), reported")


def draw(path: Path) -> None:
    """Draw the picture."""
    seen = search()
    with sheet(path, 8.2, 5.6) as figure:
        axes = figure.subplots(2, 3, width_ratios=(1.25, 1.25, 1.0))
        draw_image(axes[0, 0], seen, 0, LETTERS)
        letter(axes[0, 0], "A", "cam1: nobody is known yet")
        draw_image(axes[0, 1], seen, 1, "123")
        letter(axes[0, 1], "B", "cam2, the same moment")
        draw_scores(axes[0, 2], seen)
        draw_floor(axes[1, 0], seen)
        draw_gaps(axes[1, 1], seen)
        draw_times(axes[1, 2], seen)
