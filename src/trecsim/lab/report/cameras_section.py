"""Cameras: coverage of the floor, support of the joints, reprojection error."""

from typing import TYPE_CHECKING

import numpy as np

from trecsim.lab.evaluation.reprojection import ALL_JOINTS
from trecsim.lab.report.coverage import MOST_COUNTED, CameraFacts
from trecsim.lab.report.page import Block, Figure, Section, Table, Text
from trecsim.lab.report.plan_section import draw_rig, lay_plan, smoothed
from trecsim.lab.report.recording import Recording
from trecsim.lab.report.style import (
    ACCENT,
    LINE,
    SOFT,
    WIDE_IN,
    as_svg,
    colour_of,
    css_colour,
    draw_spreads,
    figure,
    quiet,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLE = "Cameras"
SHADE = 0.75  # all cameras together, about
COUNTS = ("no camera", "1 camera", "2 cameras", "3 cameras", "4 cameras")


def section(recording: Recording, facts: CameraFacts | None) -> Section:
    """Return coverage, support and reprojection error."""
    if facts is None:
        needed = "To show the cameras, give the rig with --rig."
        if recording.rig is not None:
            needed = "Nobody was tracked: there is nothing to compare the cameras with."
        return Section(TITLE, [Text(needed, "missing")])
    blocks: list[Block] = [
        Figure(_coverage(facts), _coverage_caption(facts), "Coverage and support"),
        _table(facts),
    ]
    if facts.found is not None and facts.found.overall.n:
        blocks.append(Figure(_errors(facts), _ERRORS_CAPTION, "Reprojection error"))
    else:
        blocks.append(
            Text(
                "The reprojection error needs the 2D poses: set poses = true under [output] in the "
                "site file, or give --poses.",
                "missing",
            )
        )
    return Section(TITLE, blocks)


_ERRORS_CAPTION = (
    "Distance in the raw image between each key point and the projected joint of its track, per "
    "camera. The dot is the median, the bar ends at the 90th percentile. A camera that stands out "
    "was moved, is out of focus, or its clock is off."
)


def _coverage_caption(facts: CameraFacts) -> str:
    several = facts.by_count[2:].sum()
    walked = facts.sees.sum(axis=0)[facts.walked]
    floor = float((walked >= 2).mean()) if len(walked) else 0.0
    return (
        "Left: number of cameras that see the floor, obstacles not considered; the dashed outline "
        "encloses the area where people were. "
        f"Two or more cameras see {100 * floor:.0f} % of that area. Right: two or more cameras had "
        f"the person in view in {100 * several:.0f} % of the person-frames, and supported "
        f"{100 * facts.supported[2:].sum():.0f} % of the joints. The other joints were hidden, not "
        "detected, or rejected as outliers."
    )


def _coverage(facts: CameraFacts) -> str:
    from matplotlib.colors import to_rgba

    left_in = 0.56 * WIDE_IN
    plan_in = min(left_in * facts.extent.depth_m / facts.extent.width_m, 7.0)
    number = facts.sees.sum(axis=0)
    alpha = SHADE / max(int(number.max()), 1)
    with figure(max(plan_in + 0.5, 3.2)) as drawing:
        plan, bars = drawing.subplots(1, 2, width_ratios=(1.35, 1.0))
        for margin in facts.margin:
            if (margin > 0).any():
                plan.contourf(
                    facts.x_m, facts.y_m, margin, [0, 10], colors=[ACCENT], alpha=alpha, zorder=1
                )
        if facts.walked.any() and not facts.walked.all():
            plan.contour(
                facts.x_m, facts.y_m, smoothed(facts.walked.astype(float)), [0.5],
                colors=[SOFT], linewidths=1.0, linestyles="dashed", zorder=3,
            )  # fmt: skip
        lay_plan(plan, facts.extent)
        plan.grid(visible=False)
        for count in np.unique(number).tolist():
            shade = to_rgba(ACCENT, 1 - (1 - alpha) ** count)
            plan.plot([], [], "s", ms=9, mfc=shade, mec=LINE, mew=0.6, label=str(count))
        plan.legend(
            title="cameras that see the floor", loc="upper right", bbox_to_anchor=(1.0, -0.005),
            ncols=10, handletextpad=0.1, columnspacing=1.0, title_fontsize=8.5,
        )  # fmt: skip
        _draw_counts(bars, facts)
        draw_rig(plan, facts.rig, colours=[colour_of(n) for n in range(len(facts.rig))])
        return as_svg(drawing, "coverage")


def _draw_counts(axes: "Axes", facts: CameraFacts) -> None:
    classes = min(len(facts.rig), MOST_COUNTED) + 1
    names = list(COUNTS[:classes])
    if len(facts.rig) > MOST_COUNTED:
        names[-1] = f"{MOST_COUNTED} or more"
    rows = np.arange(classes)
    for offset, shares, colour, name in (
        (-0.19, facts.by_count[:classes], SOFT, "person in view of"),
        (0.19, facts.supported[:classes], ACCENT, "joint supported by"),
    ):
        axes.barh(rows + offset, 100 * shares, height=0.34, color=colour, label=name)
        for row, share in zip(rows, shares, strict=True):
            text = f"{100 * share:.0f} %" if share >= 0.005 or share == 0 else "< 1 %"
            axes.text(100 * share + 1.2, row + offset, text, va="center", fontsize=8, color=SOFT)
    axes.set_yticks(rows, names)
    axes.set(xlim=(0, 112), xlabel="share of the time [%]", ylim=(max(classes, 3) - 0.4, -0.6))
    axes.set_xticks([0, 25, 50, 75, 100])
    quiet(axes, grid="x")
    axes.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=2, handlelength=1.0)


def _table(facts: CameraFacts) -> Table:
    columns = ["camera", "height", "floor seen", "people in view"]
    rows = []
    for number, camera in enumerate(facts.rig):
        walked = facts.sees[number][facts.walked]
        row = [
            camera.name,
            f"{camera.position_m[2]:.2f} m",
            f"{100 * walked.mean():.0f} %" if len(walked) else "–",
            f"{100 * facts.in_view[number]:.0f} %",
        ]
        rows.append([*row, *_found_cells(facts, camera.name)])
    caption = (
        "Floor seen: share of the area where people were. People in view: share of the "
        "person-frames in which the camera had most of the person in its image."
    )
    if facts.found is not None:
        columns += ["images", "detections matched", "median error", "90th percentile"]
        caption += (
            " Detections matched: share of the detected people that belong to a track; the others "
            "are false detections, or people who were not tracked. Errors in pixels of the raw "
            "image."
        )
    swatches = [css_colour(number) for number in range(len(facts.rig))]
    return Table(columns, rows, caption, swatches=swatches)


def _found_cells(facts: CameraFacts, name: str) -> list[str]:
    if facts.found is None:
        return []
    camera = next(row for row in facts.found.cameras if row.camera == name)
    error = next(row for row in facts.found.rows if (row.camera, row.joint) == (name, ALL_JOINTS))
    matched = f"{100 * camera.matched / camera.people:.0f} %" if camera.people else "–"
    errors = [f"{error.median_px:.1f} px", f"{error.p90_px:.1f} px"] if error.n else ["–", "–"]
    return [f"{facts.images.get(name, 0)}", matched, *errors]


def _errors(facts: CameraFacts) -> str:
    assert facts.found is not None
    rows = {row.camera: row for row in facts.found.rows if row.joint == ALL_JOINTS}
    with figure(0.7 + 0.3 * max(len(facts.rig), 2)) as drawing:
        axes = drawing.add_subplot()
        spreads = [(0.0, rows[name].median_px, rows[name].p90_px) for name in facts.rig.names]
        colours = [colour_of(number) for number in range(len(facts.rig))]
        draw_spreads(axes, facts.rig.names, spreads, colours)
        axes.set_xlabel("distance [px]")
        return as_svg(drawing, "reprojection")
