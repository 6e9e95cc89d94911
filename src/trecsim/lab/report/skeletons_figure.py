"""A skeleton of each person at a good moment, from the front and from the side."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Float64, Integer

from trecsim.lab.report.recording import Recording
from trecsim.lab.report.style import FAINT, INK, PAPER, SOFT, WIDE_IN, as_svg, colour_of, figure
from trecsim.skeleton import COCO17

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CAPTION = (
    "Each person at the moment at which most joints are supported by two or more cameras: left "
    "from the front, right from the person's right side. Filled joints are supported by two or "
    "more cameras, open ones by one, crosses by none; pale discs are one standard deviation. L "
    "and R are the person's left and right."
)
FEWEST_COLUMNS, MOST_COLUMNS = 3, 4
VIEW_M = 0.62  # from the middle of a person to the edge of a view
LOWEST_M, HIGHEST_M = -0.25, 2.15
HEAD_M = 0.1  # radius of the circle for the head
FRONT, SIDE = -VIEW_M, VIEW_M  # where the middle of each view is drawn

_SIDES = [
    tuple(COCO17.index(f"{side}_{joint}") for side in ("left", "right"))
    for joint in ("shoulder", "hip")
]


def skeletons(recording: Recording) -> str:
    """Return a drawing of each person shown; empty if no frame has enough joints."""
    chosen = [(stay.person, best_row(recording, stay.person)) for stay in recording.shown]
    found = [(person, row) for person, row in chosen if row is not None]
    if not found:
        return ""
    sample = recording.sample
    rows = [row for _, row in found]
    low_m, high_m = _heights(sample.xyz_m[rows])
    columns = min(max(len(found), FEWEST_COLUMNS), MOST_COLUMNS)
    count = -(-len(found) // columns)
    high_in = (high_m - low_m) / (4 * VIEW_M) * WIDE_IN / columns
    with figure(count * (high_in + 0.35)) as drawing:
        grid = drawing.subplots(count, columns, squeeze=False).ravel()
        for axes, (person, row) in zip(grid, found, strict=False):
            colour = colour_of(recording.number[person])
            xyz_m = sample.xyz_m[row].astype(np.float64)
            _draw_floor(axes, low_m, high_m)
            for across, at_m in zip(_axes_of(xyz_m), (FRONT, SIDE), strict=True):
                _draw_view(axes, _seen(xyz_m, across, at_m), sample.support[row], colour)
                _draw_sigma(axes, _seen(xyz_m, across, at_m), sample.sigma_m[row], colour)
            at = recording.clock(float(recording.t_s[row]))
            axes.set_title(
                f"person {person}, at {at:.3g} {recording.clock.unit}",
                color=colour,
                fontweight="bold",
            )
        for axes in grid[len(found) :]:
            axes.set_axis_off()
        return as_svg(drawing, "skeletons")


def best_row(recording: Recording, person: int) -> int | None:
    """Return the row of the sample in which most joints of a person are well supported."""
    sample = recording.sample
    rows = np.flatnonzero(sample.id == person)
    known = np.isfinite(sample.xyz_m[rows]).all(axis=-1)
    rows, known = rows[known.sum(axis=1) >= 5], known[known.sum(axis=1) >= 5]
    if not len(rows):
        return None
    firm = (known & (sample.support[rows] >= 2)).sum(axis=1)
    sigma_m = np.where(known, np.nan_to_num(sample.sigma_m[rows], nan=1.0), 0.0).mean(axis=1)
    best = np.lexsort((np.arange(len(rows)), sigma_m, -known.sum(axis=1), -firm))
    return int(rows[best[0]])


def _heights(xyz_m: Float[np.ndarray, "person 17 3"]) -> tuple[float, float]:
    low_m, high_m = np.nanmin(xyz_m[..., 2]) - 0.15, np.nanmax(xyz_m[..., 2]) + 0.2
    return max(min(float(low_m), LOWEST_M), -3.0), min(max(float(high_m), HIGHEST_M), 6.0)


def _axes_of(xyz_m: Float64[np.ndarray, "17 3"]) -> tuple[Float64[np.ndarray, " 3"], ...]:
    """Return the horizontal directions to a person's left, and ahead."""
    across = np.array([xyz_m[left] - xyz_m[right] for left, right in _SIDES])[:, :2]
    across = across[np.isfinite(across).all(axis=1)].sum(axis=0)
    length_m = float(np.linalg.norm(across))
    x, y = across / length_m if length_m > 1e-6 else (1.0, 0.0)
    return np.array([x, y, 0.0]), np.array([y, -x, 0.0])


def _seen(
    xyz_m: Float64[np.ndarray, "17 3"], across: Float64[np.ndarray, " 3"], at_m: float
) -> Float64[np.ndarray, "17 2"]:
    """Return the joints as seen at right angles to a direction, around a place of the panel [m]."""
    offset_m = xyz_m @ across
    return np.stack((at_m + offset_m - np.nanmedian(offset_m), xyz_m[:, 2]), axis=-1)


def _draw_floor(axes: "Axes", low_m: float, high_m: float) -> None:
    axes.set(xlim=(-2 * VIEW_M, 2 * VIEW_M), ylim=(low_m, high_m), aspect="equal")
    axes.set_xticks([])
    heights_m = np.arange(0.0, high_m, 0.5)
    axes.set_yticks(heights_m, [f"{z:g} m" if z % 1 == 0 else "" for z in heights_m])
    axes.tick_params(length=0)
    axes.grid(axis="y", color=FAINT)
    axes.axhline(0.0, color=INK, linewidth=1.0, zorder=2)
    for spine in axes.spines.values():
        spine.set_visible(False)
    for text, x in (("R", FRONT - 0.42), ("L", FRONT + 0.42)):
        axes.text(x, low_m + 0.04, text, ha="center", va="bottom", color=SOFT, fontsize=7.5)


def _draw_view(
    axes: "Axes",
    xz_m: Float64[np.ndarray, "17 2"],
    support: Integer[np.ndarray, " 17"],
    colour: str,
) -> None:
    for first, second in COCO17.limbs:
        if min(first, second) > 4:
            alpha = 1.0 if min(support[first], support[second]) >= 2 else 0.45
            axes.plot(*xz_m[[first, second]].T, color=colour, linewidth=2.2, alpha=alpha, zorder=3)
    _draw_head(axes, xz_m, colour)
    for joint in range(5, len(xz_m)):
        marker, face = ("x", colour) if support[joint] == 0 else ("o", PAPER)
        face = colour if support[joint] >= 2 else face
        axes.plot(*xz_m[joint], marker, ms=4.2, mfc=face, mec=colour, mew=1.1, zorder=4)


def _draw_head(axes: "Axes", xz_m: Float64[np.ndarray, "17 2"], colour: str) -> None:
    from matplotlib.patches import Circle

    face_m = xz_m[:5][np.isfinite(xz_m[:5]).all(axis=1)]
    if not len(face_m):
        return
    middle_m, neck_m = face_m.mean(axis=0), xz_m[5:7].mean(axis=0)
    if np.isfinite(neck_m).all():
        axes.plot(*np.stack((neck_m, middle_m)).T, color=colour, linewidth=2.2, zorder=3)
    x, z = (float(value) for value in middle_m)
    axes.add_patch(
        Circle((x, z), HEAD_M, facecolor=PAPER, edgecolor=colour, linewidth=2.0, zorder=4)
    )


def _draw_sigma(
    axes: "Axes",
    xz_m: Float64[np.ndarray, "17 2"],
    sigma_m: Float[np.ndarray, " 17"],
    colour: str,
) -> None:
    from matplotlib.patches import Circle

    for (x, z), radius_m in zip(xz_m.tolist(), sigma_m.tolist(), strict=True):
        if np.isfinite([x, z, radius_m]).all():
            disc = Circle((x, z), radius_m, facecolor=colour, alpha=0.16, linewidth=0, zorder=2)
            axes.add_patch(disc)
