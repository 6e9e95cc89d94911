"""A wrist that one camera sees: the two places on its ray that the forearm leaves open."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float64

from parts import by_name
from pictured.runs import course, joint, made, tracked, truth_at, without
from pictured.sheet import BLUE, GREEN, GREY, ORANGE, TRUTH, letter, sheet
from trecsim.geometry import Camera
from trecsim.lab.simulation import Simulation
from trecsim.values import Poses2D, Snapshot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCENE, SECONDS, PERSON = "one-person", 9.0, 0
EYE, OTHER = "cam2", "cam1"
WRIST, ELBOW = joint("right_wrist"), joint("right_elbow")
FROM_S, UNTIL_S = 2.6, 5.6
AROUND_S = (2.2, 6.4)
AT_S = 4.6
CHOICE = "other place of a limb"
SIGMA_90, REGION_90 = 1.645, 4.605**0.5  # standard deviations: in one direction, in a plane


def hidden(view: Poses2D) -> Bool[np.ndarray, "person joint"]:
    """Return which key points are taken away."""
    gone = np.zeros(view.score.shape, bool)
    if view.camera == OTHER and FROM_S <= view.t_s < UNTIL_S:
        gone[:, WRIST] = True
    return gone


@dataclass(frozen=True, slots=True, eq=False)
class Arm:
    """What was reported of a forearm, over time, along the rays of one camera.

    Attributes
    ----------
    t_s
        Times [s].
    wrist_m, elbow_m, cov_m2
        Reported places, and the covariance of the wrist.
    truth_m
        Where wrist and elbow are, (time, 2, 3).
    ray
        Unit vector from the camera to the reported wrist.
    """

    t_s: Float64[np.ndarray, " time"]
    wrist_m: Float64[np.ndarray, "time 3"]
    elbow_m: Float64[np.ndarray, "time 3"]
    cov_m2: Float64[np.ndarray, "time 3 3"]
    truth_m: Float64[np.ndarray, "time 2 3"]
    ray: Float64[np.ndarray, "time 3"]

    def along(self, xyz_m: Float64[np.ndarray, "time 3"]) -> Float64[np.ndarray, " time"]:
        """Return how far points lie behind the reported wrist, as the camera sees it [m]."""
        return np.einsum("ta,ta->t", xyz_m - self.wrist_m, self.ray)

    def sigma_m(self) -> Float64[np.ndarray, " time"]:
        """Return the stated standard deviation along the ray [m]."""
        return np.sqrt(np.einsum("ta,tab,tb->t", self.ray, self.cov_m2, self.ray))


def arm_of(run: Simulation, snapshots: list[Snapshot], eye: Camera) -> Arm:
    """Return what was reported of the forearm."""
    wrist = course(snapshots, PERSON, WRIST, AROUND_S)
    elbow = course(snapshots, PERSON, ELBOW, AROUND_S)
    ray = wrist.xyz_m - eye.position_m
    return Arm(
        wrist.t_s, wrist.xyz_m, elbow.xyz_m, wrist.cov_m2,
        truth_at(run, PERSON, wrist.t_s)[:, [WRIST, ELBOW]],
        ray / np.linalg.norm(ray, axis=1, keepdims=True),
    )  # fmt: skip


def draw_plane(axes: "Axes", arm: Arm) -> None:
    """Draw the plane of the ray and the forearm at one moment, in centimetres from the elbow."""
    from matplotlib.patches import Circle, Ellipse

    n = int(np.abs(arm.t_s - AT_S).argmin())
    ray, elbow_m = arm.ray[n], arm.elbow_m[n]
    limb_m = arm.wrist_m[n] - elbow_m
    aside = limb_m - (limb_m @ ray) * ray
    frame = 100 * np.stack((ray, aside / np.linalg.norm(aside)))
    wrist, other = frame @ limb_m, frame @ (aside - (limb_m @ ray) * ray)
    axes.add_patch(Circle((0, 0), float(np.hypot(*wrist)), fill=False, color=GREY, linestyle="--"))
    size_cm2, axis = np.linalg.eigh(frame @ arm.cov_m2[n] @ frame.T)
    angle = np.degrees(np.arctan2(axis[1, 1], axis[0, 1]))
    width, height = 2 * REGION_90 * np.sqrt(size_cm2[::-1])
    axes.add_patch(Ellipse(tuple(wrist), width, height, angle=float(angle), color=BLUE, alpha=0.15))
    axes.axhline(wrist[1], color=GREY, linewidth=0.8, linestyle=":")
    truth = (arm.truth_m[n] - elbow_m) @ frame.T
    axes.plot(*truth.T, color=TRUTH, linewidth=5.0, alpha=0.25, solid_capstyle="round")
    axes.plot(*truth[0], "o", color=TRUTH, alpha=0.4, markersize=8, markeredgewidth=0)
    axes.plot((0, other[0]), (0, other[1]), color=ORANGE, linewidth=1.2, linestyle="--")
    axes.plot(*other, "o", color=ORANGE, markersize=6, fillstyle="none")
    axes.plot((0, wrist[0]), (0, wrist[1]), color=BLUE, linewidth=1.8)
    axes.plot(*wrist, "o", color=BLUE, markersize=6)
    axes.plot(0, 0, "o", color="0.3", markersize=4)
    axes.annotate("elbow", (0, 0), (0, -11), textcoords="offset points", ha="center", color="0.3")
    axes.annotate(
        f"{EYE} $\\rightarrow$", (0.02, wrist[1]), (0, 3), xycoords=("axes fraction", "data"),
        textcoords="offset points", color=GREY,
    )  # fmt: skip
    axes.set(aspect="equal", xlabel="along the ray [cm]", ylabel="across it [cm]")
    axes.set(xlim=(-50, 88), ylim=(-38, 48))
    letter(axes, "A", f"Ray and forearm at {AT_S:g} s; grey: truth")


def draw_depth(axes: "Axes", arm: Arm, kept: Arm) -> None:
    """Draw, over time, where the wrist is along the ray: truly, as stated, and never moved."""
    region_cm = 100 * SIGMA_90 * arm.sigma_m()
    off_cm = -100 * arm.along(arm.truth_m[:, 0])
    other_cm = off_cm + 200 * arm.along(arm.elbow_m)
    alone = (arm.t_s >= FROM_S) & (arm.t_s < UNTIL_S)
    axes.axvspan(FROM_S, UNTIL_S, color="0.95", zorder=0, linewidth=0)
    axes.fill_between(
        arm.t_s, off_cm - region_cm, off_cm + region_cm, color=BLUE, alpha=0.15, lw=0,
        label="90 % region",
    )  # fmt: skip
    axes.plot(arm.t_s, off_cm, color=BLUE, label="reported wrist")
    axes.plot(
        arm.t_s, np.where(alone, other_cm, np.nan), "--", color=ORANGE, label="the other place"
    )
    axes.plot(
        kept.t_s, -100 * kept.along(kept.truth_m[:, 0]), ":", color=GREEN, linewidth=1.6,
        label="if it stays where it is",
    )  # fmt: skip
    axes.axhline(0.0, color=TRUTH, linewidth=1.1, label="truth")
    axes.set(xlim=AROUND_S, xlabel="time [s]", ylabel=f"behind the truth, as {EYE} sees it [cm]")
    letter(axes, "B", f"Over time; grey: {OTHER} does not show the wrist")


def draw(path: Path) -> None:
    """Draw the picture."""
    run = made(SCENE, SECONDS)
    poses, eye = without(run.poses, hidden), run.rig[EYE]
    arm = arm_of(run, tracked(run, poses=poses), eye)
    with by_name()[CHOICE].off():
        kept = arm_of(run, tracked(run, poses=poses), eye)
    with sheet(path, 8.6, 4.0) as figure:
        plane, depth = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
        draw_plane(plane, arm)
        draw_depth(depth, arm, kept)
        figure.legend(*depth.get_legend_handles_labels(), loc="outside lower center", ncols=5)
