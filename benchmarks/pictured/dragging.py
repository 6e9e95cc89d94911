"""A joint that no camera sees is dragged along, after the thesis' figures 19 and 20."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float64

from parts import by_name
from pictured.runs import Course, course, joint, made, tracked, truth_at, without
from pictured.sheet import BLUE, GREEN, GREY, ORANGE, TRUTH, draw_body, letter, sheet
from trecsim.fusion import FusionSettings
from trecsim.lab.simulation import Simulation
from trecsim.values import Poses2D, Snapshot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCENE, SECONDS = "one-person", 9.0
HIDDEN = tuple(joint(name) for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear"))
SHOWN = joint("nose")
FROM_S, UNTIL_S = 2.6, 5.6
AROUND_S = (2.2, 6.4)
AT_S = 5.5
WAYS = (
    ("neither, as in the thesis' figure 19", ORANGE, ("lengths of limbs", "drag-along"), "--"),
    ("dragged along", GREEN, ("lengths of limbs",), "-"),
    ("and held by lengths: the tracker", BLUE, (), "-"),
)


def hidden(view: Poses2D) -> Bool[np.ndarray, "person joint"]:
    """Return which key points are taken away."""
    gone = np.zeros(view.score.shape, bool)
    if FROM_S <= view.t_s < UNTIL_S:
        gone[:, HIDDEN] = True
    return gone


def follow_without(run: Simulation, poses: list[Poses2D], off: tuple[str, ...]) -> list[Snapshot]:
    """Return what is reported while parts of the model are switched off."""
    parts = by_name()
    settings = replace(
        FusionSettings(), **{k: v for p in off for k, v in parts[p].settings.items()}
    )
    lasting = [parts[name] for name in off if parts[name].model is not None]
    if not lasting:
        return tracked(run, settings, poses=poses)
    with lasting[0].off():
        return tracked(run, settings, poses=poses)


def off_by_cm(run: Simulation, one: Course) -> Float64[np.ndarray, " time"]:
    """Return how far the joint is from the truth [cm]."""
    truth_m = truth_at(run, 0, one.t_s)[:, SHOWN]
    return 100 * np.linalg.norm(one.xyz_m - truth_m, axis=1)


def draw_body_then(axes: "Axes", run: Simulation, ways: list[list[Snapshot]]) -> None:
    """Draw the body at the end of the gap, from the side, with everybody's idea of the head."""
    t_s = min((one.t_s for one in ways[0]), key=lambda t_s: abs(t_s - AT_S))
    draw_body(axes, truth_at(run, 0, np.array([t_s]))[0][:, [0, 2]], color=TRUTH, alpha=0.3,
              linewidth=3.0)  # fmt: skip
    for (_, colour, _, _), snapshots in zip(WAYS, ways, strict=True):
        xyz_m = next(one.xyz_m[0] for one in snapshots if one.t_s == t_s)
        if colour == BLUE:
            draw_body(axes, xyz_m[:, [0, 2]], color=colour)
        head_m, neck_m = xyz_m[SHOWN, [0, 2]], xyz_m[5:7].mean(axis=0)[[0, 2]]
        axes.plot(*np.stack((neck_m, head_m)).T, ":", color=colour, linewidth=1.2)
        axes.plot(*head_m, "o", color=colour, markersize=6)
    axes.set(aspect="equal", xlabel="x [m]", ylabel="height [m]")
    axes.set_ylim(0.0, 2.1)


def draw(path: Path) -> None:
    """Draw the picture."""
    run = made(SCENE, SECONDS)
    poses = without(run.poses, hidden)
    ways = [follow_without(run, poses, off) for _, _, off, _ in WAYS]
    with sheet(path, 8.0, 5.4) as figure:
        grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.1))
        above, body = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[1, 0])
        error = figure.add_subplot(grid[0, 1])
        sure = figure.add_subplot(grid[1, 1], sharex=error)
        for (name, colour, _, line), snapshots in zip(WAYS, ways, strict=True):
            one = course(snapshots, 0, SHOWN, AROUND_S)
            sigma_m = np.sqrt(np.trace(one.cov_m2, axis1=1, axis2=2) / 3)
            above.plot(*one.xyz_m[:, :2].T, line, color=colour, linewidth=1.5)
            error.plot(one.t_s, off_by_cm(run, one), line, color=colour, label=name)
            sure.plot(one.t_s, 100 * sigma_m, line, color=colour)
        t_s = np.linspace(*AROUND_S, 300)
        above.plot(*truth_at(run, 0, t_s)[:, SHOWN, :2].T, color=TRUTH, linewidth=1.1)
        above.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
        letter(above, "A", "The nose from above; black: truth")
        draw_body_then(body, run, ways)
        letter(body, "C", f"At {AT_S:g} s, from the side; grey: truth")
        for axes in (error, sure):
            axes.axvspan(FROM_S, UNTIL_S, color="0.93", zorder=0, linewidth=0)
            axes.set(xlim=AROUND_S, ylim=(0, 120))
        error.text(
            UNTIL_S - 0.05,
            106,
            "head unseen",
            color=GREY,
            fontsize=8,
            va="top",
            ha="right",
        )
        error.set(ylabel="error of the nose [cm]", xlabel="time [s]")
        figure.legend(*error.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        sure.set(ylabel="stated uncertainty [cm]", xlabel="time [s]")
        letter(error, "B", "How far off it is")
        letter(sure, "D", "How far off it says it may be (1 sigma)")
