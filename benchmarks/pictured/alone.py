"""A person whom one camera sees: provisional, then confirmed; and half a minute that way."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float64

import one_view
from close import emptied
from pictured.runs import made, truth_at
from pictured.sheet import BLUE, GREY, ORANGE, TRUTH, letter, sheet
from trecsim.fusion.warmup import warm_up
from trecsim.geometry import Camera
from trecsim.lab.simulation import Simulation
from trecsim.tracking import Follower
from trecsim.values import PROVISIONAL, Poses2D

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCENE, SECONDS, PERSON, EYE = "gate", 6.0, 1, "cam2"
SEED, WALK = 1001, "towards and away"
TORSO = list(one_view.TORSO)
SIGMA_90 = 1.645  # of one direction
NEAR_M = 1.5  # whoever is further away is somebody else
EVERY = 5  # frame sets between two regions that are drawn
COLOURS = {True: ORANGE, False: BLUE}  # provisional or not


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What was said of the place of one person, in each frame set with that person.

    Attributes
    ----------
    t_s
        The time [s].
    truth_m, place_m, cov_m2
        Where the torso is, where it is said to be, and the covariance of that.
    provisional
        Whether the person was provisional.
    """

    t_s: Float64[np.ndarray, " time"]
    truth_m: Float64[np.ndarray, "time 3"]
    place_m: Float64[np.ndarray, "time 3"]
    cov_m2: Float64[np.ndarray, "time 3 3"]
    provisional: np.ndarray

    def depth(self, eye: Camera) -> tuple[Any, Any]:
        """Return how far the person is off along the rays of a camera, and the stated sigma [m]."""
        ray = self.truth_m - eye.position_m
        ray /= np.linalg.norm(ray, axis=1, keepdims=True)
        off_m = np.einsum("ta,ta->t", self.place_m - self.truth_m, ray)
        return off_m, np.sqrt(np.einsum("ta,tab,tb->t", ray, self.cov_m2, ray))


def seen(run: Simulation, person: int, poses: Sequence[Poses2D]) -> Seen:
    """Track, and return what is said of one person."""
    warm_up()
    follower = Follower(run.rig, provisional=True)
    rows: list[tuple[Any, ...]] = []
    for image in poses:
        for snapshot in follower.add(image):
            truth_m = truth_at(run, person, np.array([snapshot.t_s]))[0, TORSO].mean(axis=0)
            if not (np.isfinite(truth_m).all() and len(snapshot.id)):
                continue
            place_m = snapshot.xyz_m[:, TORSO].mean(axis=1)
            k = int(np.linalg.norm(place_m - truth_m, axis=1).argmin())
            if np.linalg.norm(place_m[k] - truth_m) < NEAR_M:
                cov_m2 = snapshot.cov_m2[k, TORSO].mean(axis=0)
                provisional = snapshot.state[k] == PROVISIONAL
                rows.append((snapshot.t_s, truth_m, place_m[k], cov_m2, provisional))
    return Seen(*(np.array(column) for column in zip(*rows, strict=True)))


def draw_floor(axes: "Axes", run: Simulation, one: Seen) -> None:
    """Draw places and their regions from above."""
    from matplotlib.patches import Ellipse

    axes.plot(*one.truth_m[:, :2].T, color=TRUTH, linewidth=4.0, alpha=0.25)
    for n in range(0, len(one.t_s), EVERY):
        colour = COLOURS[bool(one.provisional[n])]
        size_m2, axis = np.linalg.eigh(one.cov_m2[n, :2, :2])
        angle = np.degrees(np.arctan2(axis[1, 1], axis[0, 1]))
        width, height = 2 * np.sqrt(4.605 * size_m2[::-1])  # 90 % of two dimensions
        region = Ellipse(
            tuple(one.place_m[n, :2]), width, height, angle=float(angle), color=colour, alpha=0.15
        )
        axes.add_patch(region)
        axes.plot(*one.place_m[n, :2], "o", color=colour, markersize=4, markeredgewidth=0)
    eye_m, first_m = run.rig[EYE].position_m, one.place_m[0]
    ray = np.stack((eye_m, first_m + 0.2 * (first_m - eye_m)))[:, :2]
    axes.plot(*ray.T, color=GREY, linewidth=0.8, linestyle=":")
    axes.annotate(f"ray of {EYE}", (-2.6, 0.0), color=GREY, ha="right", va="top")
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", xlim=(-6.2, -1.8), ylim=(-0.9, 1.9))
    letter(axes, "A", "From above: 90 % regions of the place")


def draw_depth(axes: "Axes", one: Seen, eye: Camera, since_s: float) -> None:
    """Draw how far off in depth a person is, and how far it may be."""
    off_m, sigma_m = one.depth(eye)
    t_s = one.t_s - since_s
    for provisional, colour in COLOURS.items():
        which = one.provisional == provisional
        region = np.where(which, SIGMA_90 * sigma_m, np.nan)
        axes.fill_between(t_s, off_m - region, off_m + region, color=colour, alpha=0.15, lw=0)
        axes.plot(t_s, np.where(which, off_m, np.nan), color=colour)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.set(ylabel="off along the rays [m]", xlim=(t_s[0], t_s[-1]))


def draw(path: Path) -> None:
    """Draw the picture."""
    run = made(SCENE, SECONDS)
    entering = seen(run, PERSON, run.poses)
    walk, eye = one_view.made(WALK, SEED)
    poses = [image if image.camera == eye.name else emptied(image) for image in walk.poses]
    alone = seen(walk, 0, poses)
    with sheet(path, 9.0, 6.4) as figure:
        panels = figure.subplot_mosaic([["A", "B"], ["C", "C"]], width_ratios=(1.5, 1.0))
        draw_floor(panels["A"], run, entering)
        begins_s = float(run.truth_t_s[np.isfinite(run.truth_xyz_m[PERSON, :, 0, 0]).argmax()])
        draw_depth(panels["B"], entering, run.rig[EYE], begins_s)
        panels["B"].set(xlabel="time since the person is there [s]")
        letter(panels["B"], "B", "Provisional, then confirmed")
        draw_depth(panels["C"], alone, eye, 0.0)
        panels["C"].set(xlabel="time [s]")
        letter(panels["C"], "C", "Towards one camera and away from it, 3 to 8.5 m")
