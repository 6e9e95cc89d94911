"""What cameras that were left out say of the stated uncertainty."""

from typing import TYPE_CHECKING

from trecsim.lab.evaluation.left_out import CURVE, LeftOut, LeftOutRow
from trecsim.lab.report.page import Block, Figure, Table, Text
from trecsim.lab.report.style import ACCENT, LINE, as_svg, colour_of, css_colour, figure, quiet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NOT_DONE = (
    "Whether the stated uncertainty is true can be checked by the cameras themselves: people are "
    "tracked once more without each camera, and its key points are compared with what the others "
    "say. This needs the rig and the 2D poses of three cameras or more; it is done by itself for "
    "short recordings without ground truth, for others with --left-out."
)
_NOTHING = (
    "No camera could be left out: too few joints were seen by three cameras at once to tell the "
    "noise of the detector."
)


def left_out_blocks(found: LeftOut | None) -> list[Block]:
    """Return how often key points of each left-out camera lie inside the stated ellipses."""
    if found is None:
        return [Text(_NOT_DONE, "missing")]
    if not found.overall.key_points:
        return [Text(_NOTHING, "missing")]
    return [Figure(_curves(found), _caption(found), "Judged by a left-out camera"), _table(found)]


def _caption(found: LeftOut) -> str:
    row = found.overall
    return (
        "People were tracked once more without each camera and projected into its images. A "
        "perfectly stated uncertainty lies on the dashed line: above it regions are too large, "
        "below it too small. The ellipses hold the covariance of the joint and the noise of the "
        f"detector, {100 * found.noise.median_m:.1f} cm on the body (median joint), which the "
        "disagreement of three and more cameras tells; it is "
        f"{100 * row.noise_share:.0f} % of the stated variance (median): the larger, the less this "
        "tells of the tracks. False key points count. Errors that all cameras share, as of hips "
        "under clothing, cancel: regions that allow for them look too large here, and only ground "
        "truth tells whether regions that do not are too small."
    )


def _curves(found: LeftOut) -> str:
    names = [row.name for row in found.cameras[1:]]
    with figure(4.0) as drawing:
        axes: Axes = drawing.subplots()
        axes.plot([0, 100], [0, 100], color=LINE, linestyle="dashed", linewidth=1.0)
        for number, (name, curve) in enumerate(zip(names, found.curve[1:], strict=True)):
            axes.plot(100 * CURVE, 100 * curve, color=colour_of(number), linewidth=1.0, label=name)
        axes.plot(
            100 * CURVE, 100 * found.curve[0], color=ACCENT, linewidth=2.4, label="all cameras"
        )
        axes.set(
            xlim=(0, 100), ylim=(0, 100), xlabel="region should hold [%]",
            ylabel="key points inside [%]", aspect="equal",
        )  # fmt: skip
        axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), handlelength=1.4)
        quiet(axes)
        return as_svg(drawing, "left-out")


def _table(found: LeftOut) -> Table:
    overall, *cameras = found.cameras
    counts = list(zip(found.people, found.matched, strict=True))
    rows = [
        _cells(row, f"{matched} of {people}")
        for row, (people, matched) in zip(cameras, counts, strict=True)
    ]
    total = f"{sum(found.matched)} of {sum(found.people)}"
    swatches = [css_colour(number) for number in range(len(cameras))]
    return Table(
        ["camera left out", "people matched", "key points", "in 50 %", "in 90 %", "in 99 %",
         "off, median", "stated", "detector's share"],
        [*rows, _cells(overall, total)],
        "Share of the key points of score 0.3 and more inside the ellipses that are to hold 50, 90 "
        "and 99 %. Off: distance from the projected joint in the raw image. Stated: standard "
        "deviation per axis, with the detector's noise; the last column is its share in the "
        "variance. People matched: each the nearest to the other, within a quarter of the person's "
        "size; who is further off is not judged.",
        swatches=[*swatches, "transparent"],
    )  # fmt: skip


def _cells(row: LeftOutRow, matched: str) -> list[str]:
    if not row.key_points:
        return [row.name, matched, "0", *["–"] * 6]
    shares = (f"{100 * share:.0f} %" for share in (row.within_50, row.within_90, row.within_99))
    return [
        row.name, matched, str(row.key_points), *shares, f"{row.median_px:.1f} px",
        f"{row.stated_px:.1f} px", f"{100 * row.noise_share:.0f} %",
    ]  # fmt: skip
