"""The end of two people who leave: how far they are followed, and in which state."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from pictured.runs import made, tracked
from pictured.sheet import BLUE, ORANGE, TRUTH, letter, sheet
from trecsim.lab.simulation import Simulation
from trecsim.values import Snapshot

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCENE, SECONDS = "leaving-returning", 9.0
LEAVERS = (0, 1)
TORSO = [5, 6, 11, 12]
REGION_90 = 4.605**0.5  # standard deviations in a plane
LAST_S = 0.8  # what is shown of each person before the end
STATES = (("confirmed", BLUE), ("coasting", ORANGE))


@dataclass(frozen=True, slots=True, eq=False)
class End:
    """What was reported of one person at last.

    Attributes
    ----------
    t_s
        The time since the person was there last [s].
    place_m, cov_m2
        The torso, and the covariance of its joints.
    support
        Number of cameras that support any joint.
    state
        Its state.
    truth_m
        Where the torso was.
    """

    t_s: Float64[np.ndarray, " time"]
    place_m: Float64[np.ndarray, "time 3"]
    cov_m2: Float64[np.ndarray, "time 3 3"]
    support: Float64[np.ndarray, " time"]
    state: np.ndarray
    truth_m: Float64[np.ndarray, "moment 3"]


def end_of(run: Simulation, snapshots: list[Snapshot], person: int) -> End:
    """Return the end of one person: of the track that is nearest when the person is there last."""
    torso_m = run.truth_xyz_m[person][:, TORSO].mean(axis=1)
    there = np.isfinite(torso_m[:, 0])
    gone_s = float(run.truth_t_s[there][-1])
    last = max((s for s in snapshots if s.t_s <= gone_s), key=lambda s: s.t_s)
    off_m = np.linalg.norm(last.xyz_m[:, TORSO].mean(axis=1) - torso_m[there][-1], axis=1)
    identity = last.id[off_m.argmin()]
    rows = [
        (
            s.t_s - gone_s, s.xyz_m[k, TORSO].mean(axis=0),
            s.cov_m2[k, TORSO].mean(axis=0), float(s.support[k].max()),
            str(s.state[k]),
        )
        for s in snapshots
        for k in np.flatnonzero(s.id == identity)
        if s.t_s > gone_s - LAST_S
    ]  # fmt: skip
    shown = there & (run.truth_t_s > gone_s - LAST_S)
    return End(*(np.array(column) for column in zip(*rows, strict=True)), torso_m[shown])


def draw_above(axes: "Axes", ends: list[End]) -> None:
    """Draw the last steps of everybody from above."""
    from matplotlib.patches import Ellipse

    colour_of = dict(STATES)
    for one in ends:
        for place_m, cov_m2, state in zip(one.place_m, one.cov_m2, one.state, strict=True):
            size_m2, axis = np.linalg.eigh(cov_m2[:2, :2])
            width, height = 2 * REGION_90 * np.sqrt(size_m2[::-1])
            angle = float(np.degrees(np.arctan2(axis[1, 1], axis[0, 1])))
            colour = colour_of[state]
            axes.add_patch(
                Ellipse(tuple(place_m[:2]), width, height, angle=angle, color=colour, alpha=0.04)
            )
        axes.plot(*one.truth_m[:, :2].T, color=TRUTH, linewidth=6.0, alpha=0.2)
        axes.plot(*one.truth_m[-1, :2], "|", color=TRUTH, markersize=16)
        for state, colour in STATES:
            which = one.state == state
            axes.plot(*one.place_m[which, :2].T, "o", color=colour, markersize=3.5, label=state)
        axes.plot(*one.place_m[-1, :2], "x", color=ORANGE, markersize=9, label="deleted")
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", ylim=(-0.3, 1.3))
    letter(axes, "A", "From above; grey: truth")


def draw_times(axes: "Axes", ends: list[End]) -> None:
    """Draw how many cameras support a person, and how uncertain the place is."""
    for one, line in zip(ends, ("-", "--"), strict=True):
        axes.step(one.t_s, one.support, line, color="0.4", where="post", linewidth=1.0)
        for state, colour in STATES:
            sigma_m = np.sqrt(np.trace(one.cov_m2, axis1=1, axis2=2) / 3)
            sigma_cm = np.where(one.state == state, 100 * sigma_m, np.nan)
            axes.plot(one.t_s, sigma_cm, line, color=colour)
    axes.axvline(0.0, color=TRUTH, linewidth=0.8, linestyle=":")
    axes.set(xlabel="time since the person is gone [s]", ylim=(0, None))
    axes.set(ylabel="cameras (grey), stated sigma [cm]")
    letter(axes, "B", "Cameras and uncertainty; dashed: the lower one")


def draw(path: Path) -> None:
    """Draw the picture."""
    run = made(SCENE, SECONDS)
    snapshots = tracked(run)
    ends = [end_of(run, snapshots, person) for person in LEAVERS]
    with sheet(path, 8.6, 3.8) as figure:
        above, times = figure.subplots(1, 2, width_ratios=(1.0, 1.0))
        draw_above(above, ends)
        draw_times(times, ends)
        handles, names = above.get_legend_handles_labels()
        figure.legend(handles[:3], names[:3], loc="outside lower center", ncols=3)
