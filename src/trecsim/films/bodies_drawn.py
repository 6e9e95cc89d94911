"""A skeleton as strokes: far limbs first, the head as a disc, predicted joints pale."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float64

from trecsim.export.person_colours import colour
from trecsim.films.people_at import PersonAt
from trecsim.films.strokes import Colour, Pen, hex_colour
from trecsim.skeleton import COCO17

Projected = Float64[np.ndarray, "joint 2"]
Project = Callable[[Float64[np.ndarray, "point 3"]], Float64[np.ndarray, "point 2"]]

_FACE = [COCO17.index(name) for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear")]
_SHOULDERS = [COCO17.index("left_shoulder"), COCO17.index("right_shoulder")]
_HIPS = [COCO17.index("left_hip"), COCO17.index("right_hip")]
_LIMBS = [
    (COCO17.index(f"{side}_{a}"), COCO17.index(f"{side}_{b}"))
    for side in ("left", "right")
    for a, b in (
        ("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"),
    )
]  # fmt: skip
_TRUNK = [_SHOULDERS[0], _SHOULDERS[1], _HIPS[1], _HIPS[0]]
_STROKES = np.array([*((_TRUNK[at], _TRUNK[(at + 1) % 4]) for at in range(4)), *_LIMBS])
_HEAD_M = 0.11


def person_colour(person: int) -> Colour:
    """Return the colour of a person, as everywhere."""
    return hex_colour(colour(person))


def pale(tint: Colour, share: float = 0.55) -> Colour:
    """Return a colour mixed with white."""
    red, green, blue = (round(part + (255 - part) * share) for part in tint)
    return red, green, blue


def draw_body(
    pen: Pen, one: PersonAt, xy_px: Projected, px_per_m: float, rim: Colour | None = None
) -> None:
    """Draw one person.

    Parameters
    ----------
    pen
        What draws.
    one
        The person.
    xy_px
        Joints on the image [px]; NaN where they cannot be seen.
    px_per_m
        Size of a metre at the person [px].
    rim
        Colour around limbs, to tell them from a video.
    """
    tint = person_colour(one.person)
    width = float(np.clip(0.055 * px_per_m, 1.6, 14.0))
    strokes = xy_px[_STROKES]
    if rim is not None:
        pen.segments(strokes, rim, width + 2.5)
    if np.isfinite(xy_px[_TRUNK]).all():
        pen.area(xy_px[_TRUNK], tint if one.seen[_TRUNK].any() else pale(tint), 0.45)
    seen = one.seen[_STROKES].any(axis=1)
    pen.segments(strokes[~seen], pale(tint), width)
    pen.segments(strokes[seen], tint, width)
    _draw_head(pen, one, xy_px, px_per_m, tint, rim)


def _draw_head(
    pen: Pen, one: PersonAt, xy_px: Projected, px_per_m: float, tint: Colour, rim: Colour | None
) -> None:
    face = xy_px[_FACE]
    known = np.isfinite(face).all(axis=1)
    if not known.any():
        return
    middle = face[known].mean(axis=0)
    shoulders = xy_px[_SHOULDERS].mean(axis=0)
    shade = tint if one.seen[_FACE].any() else pale(tint)
    pen.line(np.stack([middle, shoulders]), shade, float(np.clip(0.05 * px_per_m, 1.5, 12.0)))
    radius = max(_HEAD_M * px_per_m, 2.5)
    if rim is not None:
        pen.disc(middle, radius + 1.5, rim)
    pen.disc(middle, radius, shade)


def highest(xy_px: Projected) -> Float64[np.ndarray, " 2"]:
    """Return where a label goes: above the middle of the highest joints; NaN if none is known."""
    known = np.isfinite(xy_px).all(axis=1)
    if not known.any():
        return np.full(2, np.nan)
    points = xy_px[known]
    face = xy_px[_FACE][np.isfinite(xy_px[_FACE]).all(axis=1)]
    x = face[:, 0].mean() if len(face) else points[:, 0].mean()
    return np.array([x, points[:, 1].min()])
