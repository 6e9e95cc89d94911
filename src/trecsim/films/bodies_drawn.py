"""Skeletons as strokes: who is far first, the head as a disc, predicted joints pale."""

from functools import cache

import numpy as np
from jaxtyping import Bool, Float64, Int32

from trecsim.export.person_colours import colour
from trecsim.films.people_at import PeopleAt
from trecsim.films.strokes import Colour, Pen, fixed, hex_colour
from trecsim.skeleton import COCO17

Projected = Float64[np.ndarray, "person joint 2"]

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


@cache
def person_colour(person: int) -> Colour:
    """Return the colour of a person, as everywhere."""
    return hex_colour(colour(person))


@cache
def pale(tint: Colour, share: float = 0.55) -> Colour:
    """Return a colour mixed with white."""
    red, green, blue = (round(part + (255 - part) * share) for part in tint)
    return red, green, blue


class Bodies:
    """Everybody in one image, with all that is drawn of them computed at once.

    Parameters
    ----------
    people
        The people.
    xy_px
        Their joints on the image [px]; NaN where they cannot be seen.
    px_per_m
        Size of a metre at each person [px].
    """

    def __init__(
        self, people: PeopleAt, xy_px: Projected, px_per_m: Float64[np.ndarray, " person"]
    ) -> None:
        self._person = people.person
        self._px_per_m: list[float] = px_per_m.tolist()
        known = np.isfinite(xy_px).all(axis=2)
        zeroed = np.where(known[..., None], xy_px, 0.0)
        joints = fixed(zeroed)
        self._strokes: Int32[np.ndarray, "person stroke 2 2"] = joints.take(_STROKES, axis=1)
        self._trunks: Int32[np.ndarray, "person corner 2"] = joints.take(_TRUNK, axis=1)
        whole = known[:, _STROKES].all(axis=2)
        seen = people.seen[:, _STROKES].any(axis=2)
        self._drawn, self._firm, self._faint = whole, whole & seen, whole & ~seen
        self._has_trunk = _bools(known[:, _TRUNK].all(axis=1))
        self._has_neck = _bools(known[:, _SHOULDERS].all(axis=1))
        self._trunk_seen = _bools(people.seen[:, _TRUNK].any(axis=1))
        self._head_seen = _bools(people.seen[:, _FACE].any(axis=1))
        faces, heads = _face_middles(zeroed, known)
        self._has_head = _bools(faces)
        self._heads_px: list[list[float]] = heads.tolist()
        necks = zeroed[:, _SHOULDERS].mean(axis=1)
        self._necks = fixed(np.stack([heads, necks], axis=1))
        self._seen_at_all = _bools(known.any(axis=1))
        middle = zeroed.sum(axis=1)[:, 0] / np.maximum(known.sum(axis=1), 1)
        self._label_x: list[float] = np.where(faces, heads[:, 0], middle).tolist()
        self._top: list[float] = np.where(known, xy_px[..., 1], np.inf).min(axis=1).tolist()

    def draw(
        self, pen: Pen, depth_m: Float64[np.ndarray, " person"], rim: Colour | None = None
    ) -> None:
        """Draw everybody with their numbers, the farthest first.

        Parameters
        ----------
        pen
            What draws.
        depth_m
            How far away each person is [m].
        rim
            Colour around limbs, to tell them from a video.
        """
        for at in np.argsort(depth_m)[::-1].tolist():
            if self._seen_at_all[at]:
                self._draw_body(pen, at, rim)
                self._draw_number(pen, at)

    def _draw_body(self, pen: Pen, at: int, rim: Colour | None) -> None:
        tint = person_colour(self._person[at])
        width = _clipped(0.055 * self._px_per_m[at], 1.6, 14.0)
        strokes = self._strokes[at]
        if rim is not None:
            pen.strokes(list(strokes[self._drawn[at]]), rim, width + 2.5)
        if self._has_trunk[at]:
            pen.fill(self._trunks[at], tint if self._trunk_seen[at] else pale(tint), 0.45)
        pen.strokes(list(strokes[self._faint[at]]), pale(tint), width)
        pen.strokes(list(strokes[self._firm[at]]), tint, width)
        if self._has_head[at]:
            self._draw_head(pen, at, tint if self._head_seen[at] else pale(tint), rim)

    def _draw_head(self, pen: Pen, at: int, shade: Colour, rim: Colour | None) -> None:
        px_per_m, head = self._px_per_m[at], self._heads_px[at]
        if self._has_neck[at]:
            pen.strokes([self._necks[at]], shade, _clipped(0.05 * px_per_m, 1.5, 12.0))
        radius = max(_HEAD_M * px_per_m, 2.5)
        if rim is not None:
            pen.disc(head, radius + 1.5, rim)
        pen.disc(head, radius, shade)

    def _draw_number(self, pen: Pen, at: int) -> None:
        """Write the number of a person above the middle of the highest joints."""
        px_per_m, person = self._px_per_m[at], self._person[at]
        size = _clipped(0.155 * px_per_m, 12.0, 21.0)
        y = self._top[at] - 0.15 * px_per_m - 0.8 * size
        pen.label(str(person), (self._label_x[at], y), size, person_colour(person))


def _face_middles(
    zeroed: Projected, known: Bool[np.ndarray, "person joint"]
) -> tuple[Bool[np.ndarray, " person"], Float64[np.ndarray, "person 2"]]:
    """Return who has a face, and where its middle is; unknown joints of `zeroed` are zero."""
    count = known[:, _FACE].sum(axis=1)
    middle = zeroed[:, _FACE].sum(axis=1) / np.maximum(count, 1)[:, None]
    return count > 0, middle


def _clipped(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


def _bools(array: Bool[np.ndarray, " person"] | np.bool_) -> list[bool]:
    found: list[bool] = np.asarray(array).tolist()
    return found
