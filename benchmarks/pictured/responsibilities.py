"""Responsibilities around joints, after the thesis' figure 12."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from pictured.runs import joint, made, tracked
from pictured.sheet import BLUE, GREY, ORANGE, draw_body, letter, sheet
from trecsim.fusion import FusionSettings, kernels
from trecsim.fusion.association import score
from trecsim.fusion.images import Images, prepare
from trecsim.fusion.model import Model, build
from trecsim.fusion.tuning import TEMPER
from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCENE, SECONDS, ANEW_S, CAMERA = "crossing-50cm", 2.2, 1.59, "cam1"
JOINT = joint("right_ankle")
THESIS_NU_PX2 = 200.0  # of its parameter set 1
COLOURS = (BLUE, ORANGE)
LEVELS = (0.1, 0.5, 0.9)


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """One image, the people whom the tracker expects in it, and what was found.

    Attributes
    ----------
    model
        Constants of the run.
    cam
        Which camera took it.
    settled, newborn
        The people: followed for a while, and just begun.
    image
        The detections.
    """

    model: Model
    cam: int
    settled: Snapshot
    newborn: Snapshot
    image: Images


def look() -> Scene:
    """Track the scene from its beginning, and again as if the cameras began at `ANEW_S`."""
    run = made(SCENE, SECONDS)
    late = [view for view in run.poses if view.t_s > ANEW_S]
    newborn = next(one for one in tracked(run, poses=late) if len(one.id) == len(COLOURS))
    settled = min(tracked(run), key=lambda one: abs(one.t_s - newborn.t_s))
    model = build(run.rig, COCO17, FusionSettings())
    views = [view for view in run.poses if view.camera == CAMERA]
    view = min(views, key=lambda view: abs(view.t_s - settled.t_s))
    return Scene(model, run.rig.names.index(CAMERA), settled, newborn, prepare([view], model))


def projected(
    scene: Scene, xyz_m: Float64[np.ndarray, "joint 3"]
) -> Float64[np.ndarray, "joint 2"]:
    """Return joints in the image [px]."""
    return np.array(
        [kernels.project(scene.model.cameras.P, scene.cam, *point)[1:3] for point in xyz_m]
    )


def inlier(
    scene: Scene, people: Snapshot, k: int, xy_px: Float64[np.ndarray, "*place 2"]
) -> Float64[np.ndarray, "*place 2"]:
    """Return the joint's responsibility for key points at `xy_px`, and their weight by the tails.

    The latter is that of the M step, relative to a key point in the joint's projection.
    """
    m, noise = scene.model, scene.model.noise
    w, u, v, du, dv = kernels.project(m.cameras.P, scene.cam, *people.xyz_m[k, JOINT])
    m_per_px = w / m.cameras.focal_px[scene.cam]
    var = (noise.sigma_m[JOINT] / m_per_px) ** 2 + noise.floor_px**2
    uu, uv, vv = kernels.image_covariance(du, dv, people.cov_m2[k, JOINT])
    found = np.empty(xy_px.shape)
    for place in np.ndindex(xy_px.shape[:-1]):
        eu, ev = xy_px[place] - (u, v)
        odds = kernels.inlier_odds(eu, ev, uu + var, uv, vv + var, m_per_px, noise.odds_m2)
        found[place] = odds / (1.0 + odds), noise.tail / (noise.tail + (eu**2 + ev**2) / var)
    return found


def draw_fields(axes: "Axes", scene: Scene, people: Snapshot, title: str) -> None:
    """Draw in a part of the image which key points each right ankle would take for its own."""
    at_px = np.array([projected(scene, xyz_m)[JOINT] for xyz_m in people.xyz_m])
    middle = at_px.mean(axis=0)
    x_px = np.arange(middle[0] - 260.0, middle[0] + 261.0, 5.0)
    y_px = np.arange(middle[1] - 290.0, middle[1] + 131.0, 5.0)
    grid_px = np.stack(np.meshgrid(x_px, y_px), axis=-1)
    for k, colour in enumerate(COLOURS):
        r = inlier(scene, people, k, grid_px)[..., 0]
        axes.contourf(x_px, y_px, r, [*LEVELS, 1.01], colors=[colour], alpha=0.18)
        for least in LEVELS[1:]:
            axes.contourf(x_px, y_px, r, [least, 1.01], colors=[colour], alpha=0.22)
        axes.contour(x_px, y_px, r, LEVELS, colors=[colour], linewidths=0.9)
        draw_body(axes, projected(scene, people.xyz_m[k]), color=colour, alpha=0.55)
    for xy_px in scene.image.xy_px:
        axes.plot(*xy_px.T, "+", color="0.15", markersize=6, markeredgewidth=1.1)
    axes.set(xlim=(x_px[0], x_px[-1]), ylim=(y_px[-1], y_px[0]), aspect="equal")
    axes.set(xlabel="column [px]", ylabel="row [px]")
    axes.grid(False)
    letter(axes, title[0], title[2:])


def thesis_share(
    at_px: Float64[np.ndarray, "person 2"], xy_px: Float64[np.ndarray, "place 2"]
) -> Float64[np.ndarray, "place person"]:
    """Return thesis eq. 33, with equal shares: every key point is somebody's."""
    d2 = ((xy_px[:, None] - at_px) ** 2).sum(axis=-1) / THESIS_NU_PX2
    weight = np.exp(-0.5 * (d2 - d2.min(axis=1, keepdims=True)))
    return np.asarray(weight / weight.sum(axis=1, keepdims=True))


def draw_cut(axes: "Axes", scene: Scene) -> None:
    """Draw the same along the line through both ankles, beside the thesis' responsibilities."""
    people = scene.settled
    at_px = np.array([projected(scene, xyz_m)[JOINT] for xyz_m in people.xyz_m])
    way_px = at_px[1] - at_px[0]
    gap_px = float(np.linalg.norm(way_px))
    s_px = np.linspace(-110.0, gap_px + 110.0, 331)
    line_px = at_px[0] + s_px[:, None] * way_px / gap_px
    theirs = thesis_share(at_px, line_px)
    for k, colour in enumerate(COLOURS):
        r, tail = inlier(scene, people, k, line_px).T
        axes.plot(s_px, theirs[:, k], ":", color=colour, linewidth=1.6)
        axes.plot(s_px, inlier(scene, scene.newborn, k, line_px)[:, 0], "--", color=colour)
        axes.plot(s_px, r, color=colour, linewidth=1.8)
        axes.fill_between(s_px, r * tail, color=colour, alpha=0.25, linewidth=0)
    for style, text in (("-", "settled"), ("--", "newborn"), (":", "thesis, eq. 33")):
        axes.plot([], [], style, color=GREY, label=text)
    axes.fill_between([], [], color=GREY, alpha=0.3, label="weight in the M step")
    axes.set(xlim=(s_px[0], s_px[-1]), ylim=(0, 1.45), yticks=(0, 0.25, 0.5, 0.75, 1))
    axes.set(xlabel="along the line through both ankles [px]", ylabel="responsibility")
    axes.legend(loc="upper center", ncols=2, columnspacing=1.2, handlelength=1.6)
    letter(axes, "C", "Far from both, a key point is nobody's")


def shares(
    scene: Scene, xy_px: Float64[np.ndarray, "joint 2"], factor: Float64[np.ndarray, " joint"]
) -> Float64[np.ndarray, " person_or_clutter"]:
    """Return whose a detection is: everybody's responsibility for it, and clutter's."""
    people = scene.settled
    ratio, _ = score(scene.model, scene.cam, xy_px[None], factor[None], people.xyz_m, people.cov_m2)
    r = [kernels.responsibility(ratio, k, 0, TEMPER) for k in range(len(ratio))]
    return np.array([*r, 1.0 - sum(r)])


def draw_people(axes: "Axes", scene: Scene) -> None:
    """Draw whose a detection is while it, or an ankle of it, changes from one into the other."""
    at_px = np.array([projected(scene, xyz_m)[JOINT] for xyz_m in scene.settled.xyz_m])
    one, other = (
        int(np.argmin(np.linalg.norm(scene.image.xy_px[:, JOINT] - own, axis=1))) for own in at_px
    )
    xy_px, factor = scene.image.xy_px[one], scene.image.sigma_scale[one]
    way_px = scene.image.xy_px[other] - xy_px
    percent = np.linspace(0.0, 100.0, 201)
    whole, ankle = np.empty((2, len(percent), 3))
    for i, share in enumerate(percent / 100.0):
        alone_px = xy_px.copy()
        alone_px[JOINT] += share * way_px[JOINT]
        whole[i] = shares(scene, xy_px + share * way_px, factor)
        ankle[i] = shares(scene, alone_px, factor)
    names = ("the blue person's", "the orange person's", "clutter's")
    for k, (colour, name) in enumerate(zip((*COLOURS, GREY), names, strict=True)):
        axes.plot(percent, whole[:, k], color=colour, linewidth=1.8, label=name)
        axes.plot(percent, ankle[:, k], "--", color=colour)
    axes.plot([], [], "--", color=GREY, label="only its right ankle moves")
    axes.set(xlim=(0, 100), ylim=(0, 1.45), yticks=(0, 0.25, 0.5, 0.75, 1))
    axes.set(ylabel="responsibility", xlabel="from the blue to the orange person's detection [%]")
    axes.legend(loc="upper center", ncols=2, columnspacing=1.2, handlelength=1.6)
    letter(axes, "D", "A detection is one person's, as a whole")


def draw(path: Path) -> None:
    """Draw the picture."""
    scene = look()
    with sheet(path, 8.0, 6.9) as figure:
        axes = figure.subplots(2, 2, height_ratios=(1.25, 1.0))
        draw_fields(
            axes[0, 0], scene, scene.settled, f"A Both followed for {scene.settled.t_s:.1f} s"
        )
        draw_fields(axes[0, 1], scene, scene.newborn, "B The same image, both just begun")
        draw_cut(axes[1, 0], scene)
        draw_people(axes[1, 1], scene)
