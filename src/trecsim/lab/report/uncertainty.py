"""Stated uncertainty of the tracks: over time, and per joint."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64

from trecsim.lab.evaluation.jitter import support_of_joints
from trecsim.lab.evaluation.left_out import LeftOut
from trecsim.lab.evaluation.person_tracks import people_of
from trecsim.lab.report.curves import curve, draw_curve
from trecsim.lab.report.left_out_section import left_out_blocks
from trecsim.lab.report.page import Figure, Section, Text
from trecsim.lab.report.recording import Recording
from trecsim.lab.report.style import ACCENT, SOFT, as_svg, draw_spreads, figure, quiet
from trecsim.skeleton import COCO17

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLE = "Uncertainty"
LEAD = (
    "Each joint has a standard deviation. It is large where few cameras support the joint, or "
    "where they look from similar directions."
)


def section(recording: Recording, left_out: LeftOut | None = None) -> Section:
    """Return the stated uncertainty over time and per joint, and what left-out cameras say."""
    sigma_m = recording.sample.sigma_m
    if not np.isfinite(sigma_m).any():
        return Section(TITLE, [Text("The tracks state no uncertainty.", "missing")])
    over_time = Figure(_over_time(recording), _OVER_TIME_CAPTION, "Over time")
    per_joint = Figure(_per_joint(recording), _PER_JOINT_CAPTION, "Per joint")
    judged = left_out_blocks(left_out) if left_out is not None or recording.truth is None else []
    return Section(TITLE, [over_time, per_joint, *judged], LEAD)


_OVER_TIME_CAPTION = (
    "Stated standard deviation of all joints of all people, per axis: the line is the median, the "
    "band holds 90 % of the joints. Below: share of the joints that two or more cameras support. "
    "The others come from one camera and the limb lengths, or are predicted from before."
)
_PER_JOINT_CAPTION = (
    "Left: stated standard deviation of each joint, per axis; the dot is the median, the bar holds "
    "90 % of the values. Right: number of cameras that support the joint, as a share of the time."
)


def _over_time(recording: Recording) -> str:
    sample = recording.sample
    t = np.repeat(recording.clock(recording.t_s), len(COCO17.joints))
    supported = np.where(np.isfinite(sample.xyz_m[..., 0]), sample.support >= 2, np.nan)
    rows = np.isfinite(supported).any(axis=1)
    share = 100 * np.nanmean(supported[rows], axis=1)
    with figure(3.8) as drawing:
        above, below = drawing.subplots(2, 1, sharex=True, height_ratios=(1.7, 1.0))
        sigma = curve(t, 100 * sample.sigma_m.ravel().astype(np.float64), together=True)
        draw_curve(above, sigma, ACCENT)
        above.set(ylabel="std. deviation [cm]", ylim=(0, _ceiling(sigma.high)))
        firm = curve(recording.clock(recording.t_s[rows]), share, together=True)
        below.plot(firm.t, firm.middle, color=SOFT)
        below.set(ylabel="2+ cameras [%]", ylim=(0, 105), xlabel=recording.clock.label)
        below.set_xlim(0, recording.length)
        for axes in (above, below):
            quiet(axes)
        drawing.align_ylabels()
        return as_svg(drawing, "sigma")


def _ceiling(high: Float64[np.ndarray, " point"]) -> float:
    """Return the upper limit of the axis: large values at a birth must not flatten the rest."""
    known = high[np.isfinite(high)]
    return float(1.15 * min(known.max(), 2.5 * np.quantile(known, 0.9))) or 1.0


def _per_joint(recording: Recording) -> str:
    spreads = []
    for values in 100 * recording.sample.sigma_m.T.astype(np.float64):
        known = values[np.isfinite(values)]
        low, middle, high = np.quantile(known if len(known) else [np.nan], (0.05, 0.5, 0.95))
        spreads.append((float(low), float(middle), float(high)))
    with figure(4.1) as drawing:
        sigma, support = drawing.subplots(1, 2, sharey=True)
        draw_spreads(sigma, COCO17.joints, spreads)
        sigma.set_xlabel("standard deviation [cm]")
        _draw_support(support, recording)
        quiet(support, grid="x")
        return as_svg(drawing, "joints")


def _draw_support(axes: "Axes", recording: Recording) -> None:
    _, *joints = support_of_joints(people_of(recording.sample))
    shares = 100 * np.nan_to_num([joint.shares for joint in joints])
    begin = np.zeros(len(shares))
    for column, (name, alpha) in enumerate(
        (("none", 0.12), ("1 camera", 0.35), ("2 cameras", 0.6), ("3 and more", 0.95))
    ):
        rows = np.arange(len(shares))
        axes.barh(
            rows, shares[:, column], left=begin, height=0.66, color=ACCENT, alpha=alpha, label=name
        )
        begin += shares[:, column]
    axes.set(xlim=(0, 100), xlabel="share of the time [%]")
    axes.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=4, handlelength=1.0)
