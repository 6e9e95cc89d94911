"""Curves with more and less smoothing, after the thesis' figures 13 to 15."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from pictured.runs import Course, course, joint, made, tracked, truth_at
from pictured.sheet import BLUE, GREEN, GREY, ORANGE, TRUTH, letter, sheet
from trecsim.fusion import FusionSettings, kernels
from trecsim.fusion.body import stiffness
from trecsim.fusion.spline import ORDER
from trecsim.geometry.triangulation import triangulate
from trecsim.lab.simulation import Simulation
from trecsim.skeleton import COCO17
from trecsim.sync import frame_sets

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SETTINGS_S, LAGS_S, EXIT_S = (4.0, 9.9), (3.5, 5.8), (4.4, 6.0)
SCENE, SECONDS, GONE_S = "one-person", 10.0, 5.12
WRIST, ANKLE = joint("left_wrist"), joint("left_ankle")
USUAL = FusionSettings()
FACTORS = ((4.0, GREEN), (0.2, ORANGE), (1.0, BLUE))
IN_90 = 1.645  # standard deviations to either side


def settings(factor: float) -> FusionSettings:
    """Return the usual settings with another smoothness of everything that moves."""
    names = ("accel_torso", "accel_head", "accel_arm", "accel_leg")
    return replace(USUAL, **{name: factor * getattr(USUAL, name) for name in names})


def raw(
    run: Simulation, number: int
) -> tuple[Float64[np.ndarray, " set"], Float64[np.ndarray, "set 3"]]:
    """Return where the two key points of each frame set meet, as if taken at once [s, m]."""
    times_s, pixels = [], []
    for one in frame_sets(run.poses):
        views = {view.camera: view for view in one.views if len(view.xy_px)}
        if len(views) == len(run.rig):
            times_s.append(np.mean([view.t_s for view in views.values()]))
            pixels.append([c.undistort(views[c.name].xy_px[0, number]) for c in run.rig])
    xyz_m, _ = triangulate(run.rig.P, np.array(pixels).swapaxes(0, 1))
    return np.array(times_s), xyz_m


def draw_truth(axes: "Axes", run: Simulation, number: int, from_s: float, until_s: float) -> None:
    """Draw the height that a joint really has."""
    t_s = np.linspace(from_s, until_s, 400)
    axes.plot(t_s, truth_at(run, 0, t_s)[:, number, 2], color=TRUTH, linewidth=1.1, label="truth")


def draw_band(axes: "Axes", one: Course, colour: str) -> None:
    """Draw where the joint is, as stated, in nine of ten cases."""
    half_m = IN_90 * np.sqrt(one.cov_m2[:, 2, 2])
    z_m = one.xyz_m[:, 2]
    axes.fill_between(one.t_s, z_m - half_m, z_m + half_m, color=colour, alpha=0.18, linewidth=0)


def draw_settings(axes: "Axes", run: Simulation) -> None:
    """Draw the newest state with more and less smoothing."""
    t_s, xyz_m = raw(run, WRIST)
    shown = (t_s >= SETTINGS_S[0]) & (t_s <= SETTINGS_S[1])
    axes.plot(
        t_s[shown], xyz_m[shown, 2], "o", color="0.72", markersize=2.5, label="key points alone"
    )
    for factor, colour in FACTORS:
        one = course(tracked(run, settings(factor)), 0, WRIST, SETTINGS_S)
        name = f"accel_arm = {factor * USUAL.accel_arm:g}"
        axes.plot(one.t_s, one.xyz_m[:, 2], color=colour, linewidth=1.4, label=name)
    draw_truth(axes, run, WRIST, *SETTINGS_S)
    axes.set(xlim=SETTINGS_S, ylim=(0.82, 1.2), xlabel="time [s]", ylabel="height of a wrist [m]")
    axes.legend(loc="upper left", ncols=3, columnspacing=1.0, handlelength=1.4)
    letter(axes, "A", "Smoothing: the newest state, two cameras")


def draw_lags(axes: "Axes", run: Simulation) -> None:
    """Draw the same with the usual smoothing, newest and later, and what is stated of it."""
    draw_truth(axes, run, ANKLE, *LAGS_S)
    for lag_s, colour in ((0.0, BLUE), (0.1, GREEN), (0.2, ORANGE)):
        one = course(tracked(run, lag_s=lag_s), 0, ANKLE, LAGS_S)
        if not lag_s:
            draw_band(axes, one, colour)
        name = f"{lag_s:g} s later" if lag_s else "newest, 90 % region"
        axes.plot(one.t_s, one.xyz_m[:, 2], ".-", color=colour, linewidth=1.3, label=name)
    axes.set(xlim=LAGS_S, ylim=(0.0, 0.42), xlabel="time [s]", ylabel="height of an ankle [m]")
    axes.legend(loc="upper left", ncols=2, columnspacing=1.0, handlelength=1.4)
    letter(axes, "B", "What comes later straightens the curve")


def draw_exit(axes: "Axes", run: Simulation) -> None:
    """Draw how curves end when the key points end."""
    poses = [view for view in run.poses if view.t_s < GONE_S]
    empty = [
        replace(
            view, xy_px=view.xy_px[:0], score=view.score[:0], person_score=view.person_score[:0]
        )
        for view in run.poses
        if GONE_S <= view.t_s <= EXIT_S[1]
    ]
    draw_truth(axes, run, ANKLE, EXIT_S[0], GONE_S)
    for factor, colour in FACTORS:
        one = course(tracked(run, settings(factor), poses=poses + empty), 0, ANKLE, EXIT_S)
        if factor == 1.0:
            draw_band(axes, one, colour)
        axes.plot(one.t_s, one.xyz_m[:, 2], ".-", color=colour, linewidth=1.3)
        axes.plot(one.t_s[-1], one.xyz_m[-1, 2], "o", color=colour, markersize=6)
    axes.axvline(GONE_S, color=GREY, linewidth=0.9, linestyle="--")
    axes.text(GONE_S + 0.02, 0.39, "seen no more", color=GREY, fontsize=8, va="top")
    axes.set(xlim=EXIT_S, ylim=(-0.1, 0.42), xlabel="time [s]", ylabel="height of an ankle [m]")
    letter(axes, "C", "Who is seen no more goes on, then ends")


def parabola(accel: float) -> tuple[Float64[np.ndarray, " time"], Float64[np.ndarray, " time"]]:
    """Return the curve through exact samples of ``y = t^2``, by the kernels of the tracker."""
    live, knot_s = 14, USUAL.knot_s
    stiff = stiffness(COCO17, replace(USUAL, accel_leg=accel))[ANKLE : ANKLE + 1]
    n = 3 * live
    R, z, c = np.zeros((1, n, n)), np.zeros((1, n)), np.zeros((1, n))
    kernels.start_all(R, z, c, np.zeros((1, 3)), np.full(1, 10.0), 10.0, stiff, 0)
    weights, rows, y = np.empty(ORDER), np.empty((3, n)), np.empty(3)
    end_s = (live - ORDER + 1) * knot_s
    for t_s in np.arange(0.0, end_s, 0.04):
        span = kernels.locate(t_s / knot_s, live, weights)
        info = np.eye(3) / USUAL.joint_sigma_m**2
        right = np.array([0.0, 0.0, t_s**2]) / USUAL.joint_sigma_m**2
        kernels.fold_gaussian(R[0], z[0], info, right, 1e-6, np.zeros(3), span, weights, rows, y)
    kernels.control_points(R[0], z[0], c[0])
    t_s = np.linspace(0.0, end_s, 200)
    curve = np.empty((len(t_s), 1, 1, 3))
    kernels.evaluate_all(c[None], t_s / knot_s, curve)
    return t_s, curve[:, 0, 0, 2]


def draw_parabola(axes: "Axes") -> None:
    """Draw splines through a parabola."""
    t_s = np.arange(0.0, 1.1, 0.04)
    axes.plot(t_s, t_s**2, "o", color="0.72", markersize=3, label="$y = t^2$")
    for accel, colour in ((0.02, ORANGE), (0.2, GREEN), (USUAL.accel_leg, BLUE)):
        axes.plot(*parabola(accel), color=colour, linewidth=1.5, label=f"accel = {accel:g}")
    axes.set(xlim=(0.0, 1.1), xlabel="t [s]", ylabel="y [m]")
    axes.legend(loc="upper left")
    letter(axes, "D", "The thesis' parabola")


def draw(path: Path) -> None:
    """Draw the picture."""
    run = made(SCENE, SECONDS)
    with sheet(path, 8.0, 6.2) as figure:
        axes = figure.subplots(2, 2, width_ratios=(1.25, 1.0))
        draw_settings(axes[0, 0], run)
        draw_lags(axes[0, 1], run)
        draw_exit(axes[1, 0], run)
        draw_parabola(axes[1, 1])
