"""Sections on calibrations with a board: pictures of corners, coverage, parameters, residuals."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.board_images import BoardSource, Grey
from trecsim.calibrating.intrinsics import Intrinsics
from trecsim.calibrating.intrinsics_verdict import IntrinsicsCheck
from trecsim.calibrating.views import View
from trecsim.extras import needed
from trecsim.lab.report.page import Block, Figure, Picture, Pictures, Section, Table
from trecsim.lab.report.style import ACCENT, SOFT, WIDE_IN, as_svg, figure

PICTURE_PX = 480  # longer side
PICTURES = 6  # of each camera
JPEG_QUALITY = 78
RESIDUAL_TIMES = 100  # how much longer than they are residuals are drawn


def intrinsics_section(
    found: Intrinsics, check: IntrinsicsCheck, source: BoardSource, number: int
) -> Section:
    """Return the section on the intrinsics of one camera."""
    rows = [
        (name, f"{value:.4g}" if n > 3 else f"{value:.2f}", f"{sd:.2g}")
        for n, (name, value, sd) in enumerate(zip(found.names, found.values, found.sd, strict=True))
    ]
    caption = "Focal lengths and principal point in pixels, then the coefficients of the lens."
    blocks: list[Block] = [
        Table(("parameter", "value", "± one sd"), rows, caption),
        _maps(found, check, number),
        Pictures(corner_pictures(source, _shown(found))),
    ]
    lead = (
        f"{len(found.views)} views, {len(found.corner_px)} corners; root mean square error "
        f"{found.rms_px:.2f} px."
    )
    return Section(f"Camera {found.camera.name}", blocks, lead)


def corner_pictures(source: BoardSource, views: Sequence[tuple[View, str]]) -> list[Picture]:
    """Return small pictures of views with their corners drawn in."""
    wanted = {view.label: (view, text) for view, text in views}
    if not wanted:
        return []
    made = {}
    for image in source.images():
        if image.label in wanted and image.label not in made:
            view, text = wanted[image.label]
            made[image.label] = Picture(_jpeg(image.grey, view), f"{image.label}: {text}")
        if len(made) == len(wanted):
            break
    return [made[label] for label in wanted if label in made]


def _shown(found: Intrinsics) -> list[tuple[View, str]]:
    """Return the views that fit worst, and some of the others."""
    order = np.argsort(-found.view_rms_px)
    chosen = [*order[:2], *order[2 :: max(len(order) // PICTURES, 1)]][:PICTURES]
    return [(found.views[n], f"error {found.view_rms_px[n]:.2f} px") for n in chosen]


def _jpeg(grey: Grey, view: View) -> bytes:
    cv2: Any = needed("pictures of boards need OpenCV", "calibrate", "cv2")
    scale = PICTURE_PX / max(grey.shape)
    small = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    drawn = cv2.cvtColor(small, cv2.COLOR_GRAY2BGR)
    for x, y in (view.seen.xy_px + 0.5) * scale - 0.5:
        centre = (round(16 * float(x)), round(16 * float(y)))
        cv2.circle(drawn, centre, 16 * 4, (60, 220, 60), 1, cv2.LINE_AA, 4)
    _, data = cv2.imencode(".jpg", drawn, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return bytes(data)


def _maps(found: Intrinsics, check: IntrinsicsCheck, number: int) -> Figure:
    width, height = found.camera.size_px
    extent = (-0.5, width - 0.5, height - 0.5, -0.5)
    with figure(min(WIDE_IN / 3 * height / width, 5.5) + 0.9) as drawing:
        corners, residuals, directions = drawing.subplots(1, 3)
        for axes, title in (
            (corners, "corners"),
            (residuals, f"errors, {RESIDUAL_TIMES} times as long"),
            (directions, "uncertainty of directions [px]"),
        ):
            axes.set(xlim=(0, width), ylim=(height, 0), aspect="equal", title=title)
            axes.set(xticks=[], yticks=[])
            for spine in axes.spines.values():
                spine.set(visible=True, color=SOFT, linewidth=0.6)
        corners.imshow(
            np.where(check.coverage > 0, check.coverage, np.nan), extent=extent, cmap="Blues",
            vmin=0, alpha=0.6, aspect="equal",
        )  # fmt: skip
        corners.plot(*found.corner_px.T, ".", color=ACCENT, ms=1.2, rasterized=True)
        _draw_residuals(residuals, found.corner_px, found.residual_px)
        shown = directions.imshow(check.direction_px, extent=extent, cmap="viridis_r", vmin=0)
        drawing.colorbar(shown, ax=directions, location="bottom", pad=0.02).outline.set_visible(
            False
        )
        svg = as_svg(drawing, f"intrinsics{number}")
    return Figure(
        svg,
        "Left: where corners were seen; white parts of the image were never reached. Middle: seen "
        "minus predicted; arrows that point the same way in one region mean that the lens model "
        "does not fit. Right: how far images of known directions are off (one standard deviation).",
    )


def _draw_residuals(
    axes: Any, xy: Float64[np.ndarray, "corner 2"], residual: Float64[np.ndarray, "corner 2"]
) -> None:
    axes.quiver(
        *xy.T, *residual.T, angles="xy", scale_units="xy", scale=1 / RESIDUAL_TIMES,
        width=0.003, color=ACCENT, rasterized=True,
    )  # fmt: skip
