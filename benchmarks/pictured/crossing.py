"""Two people brush past each other: who is who, image by image."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from pictured.responsibilities import THESIS_NU_PX2
from pictured.runs import course, joint, made, tracked, truth_at
from pictured.sheet import BLUE, GREY, ORANGE, TRUTH, draw_body, letter, sheet
from trecsim.fusion import FusionSettings, kernels
from trecsim.fusion.association import score
from trecsim.fusion.images import prepare
from trecsim.fusion.kernels.matching import TEMPER
from trecsim.fusion.model import Model, build
from trecsim.lab.simulation import Simulation
from trecsim.skeleton import COCO17
from trecsim.values import Poses2D, Snapshot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCENE, SECONDS, CAMERA = "crossing-30cm", 16.0, "cam1"
JOINT = joint("left_hip")
COLOURS = (BLUE, ORANGE)


def owner(run: Simulation, view: Poses2D) -> list[int]:
    """Return whom each detection of an image truly shows."""
    truth_px = np.array(
        [
            run.rig[view.camera].project(truth_at(run, k, np.array([view.t_s]))[0])
            for k in range(len(COLOURS))
        ]
    )
    off_px = np.linalg.norm(view.xy_px[:, None] - truth_px, axis=-1)
    return [int(k) for k in np.argmin(np.nanmedian(off_px, axis=-1), axis=1)]


def draw_ways(axes: "Axes", run: Simulation, snapshots: list[Snapshot]) -> None:
    """Draw where each identity is, over time."""
    for k, colour in enumerate(COLOURS):
        one = course(snapshots, k, JOINT)
        axes.plot(one.t_s, one.xyz_m[:, 0], color=colour, linewidth=2.6, alpha=0.6)
        truth_m = truth_at(run, k, run.truth_t_s)
        axes.plot(run.truth_t_s, truth_m[:, JOINT, 0], color=TRUTH, linewidth=0.7)
    axes.set(ylabel="left hip, x [m]", xlim=(0, SECONDS))
    axes.tick_params(labelbottom=False)
    letter(axes, "B", "Both identities over time; black: truth")


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """One image, and whom its key points go to.

    Attributes
    ----------
    t_s
        When it was taken [s].
    whole
        Everybody's responsibility for the own detection; NaN where there is none.
    single
        Everybody's responsibility for each own key point by thesis eq. 33; NaN where it is missing.
    xy_px
        Everybody's detection.
    joints_px
        Where everybody's joints are expected.
    """

    t_s: float
    whole: Float64[np.ndarray, " person"]
    single: Float64[np.ndarray, "person joint"]
    xy_px: Float64[np.ndarray, "person joint 2"]
    joints_px: Float64[np.ndarray, "person joint 2"]


def sight(run: Simulation, model: Model, view: Poses2D, people: Snapshot) -> Sight:
    """Compare an image with the people whom the tracker knows then."""
    image, shown = prepare([view], model), owner(run, view)
    cam = model.rig.names.index(view.camera)
    ratio, _ = score(model, cam, image.xy_px, image.sigma_scale, people.xyz_m, people.cov_m2)
    joints_px = np.array(
        [
            [kernels.project(model.cameras.P, cam, *joint)[1:3] for joint in one]
            for one in people.xyz_m
        ]
    )
    whole, xy_px = np.full(len(COLOURS), np.nan), np.full(joints_px.shape, np.nan)
    for d, k in enumerate(shown):
        whole[k] = kernels.responsibility(ratio, k, d, TEMPER)
        xy_px[k] = image.xy_px[d]
    d2 = ((xy_px - joints_px) ** 2).sum(axis=-1) / THESIS_NU_PX2
    other = ((xy_px - joints_px[::-1]) ** 2).sum(axis=-1) / THESIS_NU_PX2
    single = 1.0 / (1.0 + np.exp(np.clip(0.5 * (d2 - other), -700.0, 700.0)))
    return Sight(view.t_s, whole, single, xy_px, joints_px)


def draw_image(axes: "Axes", one: Sight) -> None:
    """Draw both people and their key points in the colour of whom eq. 33 gives them to."""
    for k, colour in enumerate(COLOURS):
        draw_body(axes, one.joints_px[k], color=colour, alpha=0.45, linewidth=3.0)
        for xy_px, own in zip(one.xy_px[k], one.single[k], strict=True):
            if np.isfinite(own):
                goes_to = COLOURS[k if own >= 0.5 else 1 - k]
                axes.plot(*xy_px, "os"[k], color=goes_to, mec="0.1", mew=0.8, markersize=6)
    known = one.xy_px[np.isfinite(one.xy_px[..., 0])]
    low, high = known.min(axis=0) - 40.0, known.max(axis=0) + 40.0
    axes.set(xlim=(low[0], high[0]), ylim=(high[1], low[1]), aspect="equal")
    axes.set(xlabel="column [px]", ylabel="row [px]")
    axes.grid(False)
    letter(axes, "A", f"{CAMERA} at {one.t_s:.2f} s")


def draw_shares(axes: "Axes", sights: list[Sight]) -> None:
    """Draw how much of each detection goes to whom it shows, by the thesis and here."""
    t_s = np.array([one.t_s for one in sights])
    for k, colour in enumerate(COLOURS):
        single = [100 * np.nanmean(one.single[k]) for one in sights]
        axes.plot(t_s, single, ":", color=colour, linewidth=1.5)
        axes.plot(t_s, [100 * one.whole[k] for one in sights], color=colour, linewidth=1.8)
    axes.plot([], [], color=GREY, label="here: of the detection")
    axes.plot([], [], ":", color=GREY, label="thesis eq. 33: mean of its key points")
    axes.set(
        xlim=(0, SECONDS), ylim=(50, 102), xlabel="time [s]", ylabel="with the right person [%]"
    )
    axes.legend(loc="lower left")
    letter(axes, "C", "Responsibility of whom it shows")


def draw(path: Path) -> None:
    """Draw the picture."""
    run = made(SCENE, SECONDS)
    snapshots = tracked(run)
    model = build(run.rig, COCO17, FusionSettings())
    views = [view for view in run.poses if view.camera == CAMERA]
    sights = []
    for people in snapshots:
        view = min(views, key=lambda view: abs(view.t_s - people.t_s))
        if people.id.tolist() == [0, 1] and len(view.xy_px) == len(COLOURS):
            sights.append(sight(run, model, view, people))
    with sheet(path, 8.0, 4.6) as figure:
        grid = figure.add_gridspec(2, 2, width_ratios=(0.75, 1.25))
        draw_image(
            figure.add_subplot(grid[:, 0]), min(sights, key=lambda one: np.nanmean(one.single))
        )
        draw_ways(figure.add_subplot(grid[0, 1]), run, snapshots)
        draw_shares(figure.add_subplot(grid[1, 1]), sights)
