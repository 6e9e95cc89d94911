"""Close to one of two cameras: the body holds a leg that only one of them sees."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from parts import by_name
from pictured.runs import course, joint, made, tracked, truth_at
from pictured.sheet import BLUE, GREY, ORANGE, TRUTH, draw_body, letter, sheet
from trecsim.geometry import Camera
from trecsim.lab.simulation import Simulation
from trecsim.values import Poses2D, Snapshot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCENE, SECONDS, AT_S, PERSON = "close-entry", 6.0, 2.0, 1
JOINT = joint("left_ankle")
BETWEEN_S = (1.2, 4.0)
IN_90 = 2.5003  # standard deviations: nine of ten errors of three equal axes are smaller
WAYS = (("without the lengths of limbs", ORANGE), ("with them: the tracker", BLUE))


def shown(camera: Camera, view: Poses2D, run: Simulation) -> int:
    """Return which detection shows the person."""
    xyz_m = truth_at(run, PERSON, np.array([view.t_s]))[0]
    off_px = np.linalg.norm(view.xy_px - camera.project(xyz_m), axis=-1)
    return int(np.argmin(np.nanmedian(off_px, axis=1)))


def draw_image(axes: "Axes", run: Simulation, camera: Camera) -> None:
    """Draw the person as a camera sees it: truth, image border, key points."""
    views = [view for view in run.poses if view.camera == camera.name and len(view.xy_px)]
    view = min(views, key=lambda view: abs(view.t_s - AT_S))
    truth_m = truth_at(run, PERSON, np.array([view.t_s]))[0]
    draw_body(axes, camera.project(truth_m), color=TRUTH, alpha=0.25, linewidth=3.0)
    axes.plot(*view.xy_px[shown(camera, view, run)].T, "+", color="0.1", markersize=6)
    width, height = camera.size_px
    axes.plot([0, width, width, 0, 0], [0, 0, height, height, 0], color="0.3", linewidth=1.0)
    axes.set(xlim=(-60, width + 60), ylim=(1.16 * height, -60), aspect="equal")
    axes.set(xlabel="column [px]", ylabel="row [px]")
    axes.grid(False)


def draw_side(axes: "Axes", run: Simulation, ways: list[list[Snapshot]]) -> None:
    """Draw the person from the side: truth, and what is made of it."""
    t_s = min((one.t_s for one in ways[0]), key=lambda t_s: abs(t_s - AT_S))
    at = [0, 2]
    truth_m = truth_at(run, PERSON, np.array([t_s]))[0]
    draw_body(axes, truth_m[:, at], color=TRUTH, alpha=0.25, linewidth=3.0)
    for (_, colour), snapshots in zip(WAYS, ways, strict=True):
        moment = next(one for one in snapshots if one.t_s == t_s)
        xyz_m = moment.xyz_m[moment.id.tolist().index(PERSON)]
        draw_body(axes, xyz_m[:, at], color=colour)
        axes.plot(*xyz_m[JOINT, at], "o", color=colour, markersize=5)
    for camera in run.rig:
        axes.plot(*camera.position_m[at], "s", color="0.3", markersize=6)
        axes.annotate(camera.name, camera.position_m[at], (9, -3), textcoords="offset points")
    axes.set(aspect="equal", xlabel="x [m]", ylabel="height [m]")
    letter(axes, "C", f"At {AT_S:g} s, from the side; grey: truth")


def draw_errors(axes: "Axes", run: Simulation, ways: list[list[Snapshot]]) -> None:
    """Draw how far off the ankle is, and how far off it is said to be."""
    for (name, colour), snapshots in zip(WAYS, ways, strict=True):
        one = course(snapshots, PERSON, JOINT, BETWEEN_S)
        truth_m = truth_at(run, PERSON, one.t_s)[:, JOINT]
        sigma_m = np.sqrt(np.trace(one.cov_m2, axis1=1, axis2=2) / 3)
        axes.fill_between(one.t_s, 0, 100 * IN_90 * sigma_m, color=colour, alpha=0.15, linewidth=0)
        off_cm = 100 * np.linalg.norm(one.xyz_m - truth_m, axis=1)
        axes.plot(one.t_s, off_cm, color=colour, linewidth=1.6, label=name)
    few = one.support < 2
    axes.plot(one.t_s[few], np.zeros(few.sum()), "s", color=GREY, markersize=4, clip_on=False,
              label="seen by fewer than two cameras")  # fmt: skip
    axes.set(xlim=BETWEEN_S, ylim=(0, 160))
    axes.set(xlabel="time [s]", ylabel="error of the left ankle [cm]")
    letter(axes, "D", "Errors; shaded: 90 % are said to be less")


def draw(path: Path) -> None:
    """Draw the picture."""
    run = made(SCENE, SECONDS)
    with by_name()["lengths of limbs"].off():
        loose = tracked(run)
    ways = [loose, tracked(run)]
    with sheet(path, 8.0, 5.8) as figure:
        axes = figure.subplots(2, 2, height_ratios=(1.0, 1.1))
        for panel, camera, name in zip(axes[0], run.rig, "AB", strict=True):
            draw_image(panel, run, camera)
            letter(panel, name, f"{camera.name} at {AT_S:g} s: key points (+) and truth")
        draw_side(axes[1, 0], run, ways)
        draw_errors(axes[1, 1], run, ways)
        handles, names = axes[1, 1].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=3)
