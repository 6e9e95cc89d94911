"""The report on a calibration, of whatever kind: verdict, cameras, and the room as a map."""

import math
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np

from trecsim.calibrating.result import CalibrationResult
from trecsim.calibrating.room_error import PoseCovariance, expected_error_m
from trecsim.geometry.rig import Rig
from trecsim.lab.plots.rig_plot import floor_views
from trecsim.lab.report.page import Block, Figure, Section, Table, Text, page
from trecsim.lab.report.plan_section import Extent, draw_rig, lay_plan
from trecsim.lab.report.style import SOFT, as_svg, figure, need_matplotlib
from trecsim.store.atomic import atomic_write

MEANING = {
    "good": "Good: use it.",
    "usable": "Usable: it works, and more or better recordings would improve it.",
    "wrong": "Wrong: do not use it.",
}
HEIGHT_M = 1.0  # at which the map is drawn: that of the hips
MAP_HEIGHT_IN = 6.4
MAP_CELLS = 90
WORST_SHOWN_M = 0.05  # of the colour scale: beyond it a map of people is of no use


def write_calibration_report(
    out: Path,
    title: str,
    result: CalibrationResult,
    *,
    rig: Rig | None = None,
    covariance: PoseCovariance | None = None,
    sections: Sequence[Section] = (),
    source: str = "",
) -> None:
    """Write the report on a calibration: one HTML file that needs nothing else.

    Parameters
    ----------
    out
        The file.
    title
        Its heading.
    result
        Verdict and figures.
    rig, covariance
        The cameras in the room and what is unknown about their poses, for the map of the expected
        error; none for intrinsics.
    sections
        What else belongs to this kind of calibration: corners, coverage, offsets.
    source
        What it was computed from, for the last line.

    Raises
    ------
    SetupError
        Matplotlib or Jinja is not installed.
    """
    need_matplotlib()
    parts = [_verdict(result), _cameras(result)]
    if rig is not None and covariance is not None:
        parts.append(_room(rig, covariance))
    now = datetime.now(UTC)
    made = f"Made by trecsim {version('mc3d-trecsim')} on {now:%d %B %Y}"
    footer = f"{made} from {source}" if source else made
    with atomic_write(out, private=True) as file:  # it may hold pictures of people
        file.write(page(title, [*parts, *sections], footer=footer))


def _verdict(result: CalibrationResult) -> Section:
    meaning = MEANING[result.verdict]
    good = result.verdict == "good"
    blocks: list[Block] = [Text(meaning, "good") if good else Text(meaning, "warning")]
    blocks.extend(Text(f"{reason[:1].upper()}{reason[1:]}.") for reason in result.reasons)
    return Section("Verdict", blocks)


def _cameras(result: CalibrationResult) -> Section:
    columns = ("camera", "rotation ± deg", "position ± mm", "clock s", "drift ppm", "error px")
    rows = [
        (
            camera.name,
            _number(camera.rotation_sd_deg, 3),
            _number(1e3 * camera.position_sd_m, 1),
            _number(camera.time_offset_s, 4),
            _number(camera.time_drift_ppm, 1),
            _number(camera.reprojection_px, 2),
        )
        for camera in result.cameras
    ]
    used = [
        column
        for column in range(len(columns))
        if column == 0 or any(row[column] != "-" for row in rows)
    ]
    caption = (
        "±: one standard deviation per axis, after the best alignment of all cameras together. "
        "With probability 90 % the error is below 2.5 of them. Error: root mean square distance "
        "between what was seen and what the calibration predicts; it is small in wrong "
        "calibrations, too."
    )
    table = Table(
        [columns[column] for column in used],
        [[row[column] for column in used] for row in rows],
        caption,
    )
    return Section("Cameras", [table])


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"


def _room(rig: Rig, covariance: PoseCovariance) -> Section:
    lead = "How far triangulated points are off because of what is unknown about the cameras."
    return Section("Expected error in the room", [room_map(rig, covariance)], lead)


def room_map(rig: Rig, covariance: PoseCovariance) -> Figure:
    """Return a map of the error that the calibration causes, at the height of the hips."""
    views = floor_views(rig)
    x_m, y_m = (np.linspace(side[0], side[-1], MAP_CELLS) for side in (views.x_m, views.y_m))
    points_m = np.stack([*np.meshgrid(x_m, y_m), np.full((MAP_CELLS, MAP_CELLS), HEIGHT_M)], -1)
    error_m = expected_error_m(rig, covariance, points_m.reshape(-1, 3)).reshape(points_m.shape[:2])
    far = np.linalg.norm(
        points_m[..., None, :2] - np.array([camera.position_m[:2] for camera in rig]), axis=-1
    )
    error_m[(far < views.range_m).sum(axis=-1) < 2] = np.nan
    extent = Extent((float(x_m[0]), float(x_m[-1])), (float(y_m[0]), float(y_m[-1])))
    known = error_m[np.isfinite(error_m)]
    top_m = float(np.clip(np.quantile(known, 0.95), 1e-3, WORST_SHOWN_M)) if len(known) else 1e-3
    with figure(MAP_HEIGHT_IN) as drawing:
        axes = drawing.add_subplot()
        lay_plan(axes, extent)
        shown = axes.imshow(
            1e3 * error_m, extent=(*extent.x_m, *extent.y_m), origin="lower", cmap="viridis_r",
            vmin=0, vmax=1e3 * top_m, alpha=0.8, zorder=2,
        )  # fmt: skip
        bar = drawing.colorbar(shown, ax=axes, shrink=0.7, pad=0.02)
        bar.set_label("expected error [mm]", color=SOFT)
        bar.outline.set_visible(False)
        bar.ax.tick_params(length=0)
        draw_rig(axes, rig)
        svg = as_svg(drawing, "room")
    middle = f"{1e3 * float(np.median(known)):.1f} mm" if len(known) else "unknown"
    return Figure(
        svg,
        f"Seen from above, for points {HEIGHT_M:g} m above the floor that two or more cameras see: "
        f"root mean square error of the triangulated point, median {middle}. Errors "
        "of the detections come on top.",
    )
