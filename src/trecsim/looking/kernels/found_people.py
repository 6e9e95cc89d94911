"""What the people found in an image say about where to look next."""

import math

from trecsim.compiler import inner, kernel

SAME_SHARE = 0.7  # somebody has moved by less than this share of the size since the last look
BORDER_SHARE = 0.05  # who is so near to the border of the image may have left it

_SHOULDERS, _HIPS, _KNEES, _ANKLES = (5, 6), (11, 12), (13, 14), (15, 16)


@inner
def middle_of(xy_px, p, pair):
    """Return the middle of the known ones of two key points of a person, and how many are."""
    x = y = 0.0
    n = 0
    for j in pair:
        if xy_px[p, j, 0] == xy_px[p, j, 0]:
            x += xy_px[p, j, 0]
            y += xy_px[p, j, 1]
            n += 1
    return (x / n, y / n, n) if n else (x, y, 0)


@inner
def turn_upright(xy_px, p):
    """Return by how many quarter turns counter-clockwise the image is to be turned for a person.

    Then the body is upright, from the ankles to the shoulders; from the knees or the hips, where
    the ankles are not known. So who only bends is upright. It is 0 where nothing is known.
    """
    top_x, top_y, known = middle_of(xy_px, p, _SHOULDERS)
    x, y, n = middle_of(xy_px, p, _ANKLES)
    if n == 0:
        x, y, n = middle_of(xy_px, p, _KNEES)
    if n == 0:
        x, y, n = middle_of(xy_px, p, _HIPS)
    if known == 0 or n == 0:
        return 0
    right, up = top_x - x, y - top_y
    if abs(right) > abs(up):
        return 1 if right > 0.0 else 3
    return 2 if up < 0.0 else 0


@inner
def enclose(xy_px, p, box_px):
    """Write the box around a person's known key points; without any it is inside out."""
    left = top = math.inf
    right = bottom = -math.inf
    for j in range(xy_px.shape[1]):
        x, y = xy_px[p, j]
        if x == x:
            left, right = min(left, x), max(right, x)
        if y == y:
            top, bottom = min(top, y), max(bottom, y)
    box_px[p, 0], box_px[p, 1], box_px[p, 2], box_px[p, 3] = left, top, right, bottom


@inner
def is_lost(before_px, b, box_px, width_px, height_px):
    """Tell whether somebody is found no more: nobody is near, and no border of the image.

    Where somebody was of whom nothing is known, nobody is lost.
    """
    left, top, right, bottom = before_px[b]
    if not (
        left <= right
        and top <= bottom
        and left > BORDER_SHARE * width_px
        and top > BORDER_SHARE * height_px
        and right < (1.0 - BORDER_SHARE) * width_px
        and bottom < (1.0 - BORDER_SHARE) * height_px
    ):
        return False
    near_px = SAME_SHARE * max(right - left, bottom - top)
    for p in range(box_px.shape[0]):
        x = 0.5 * (box_px[p, 0] + box_px[p, 2] - left - right)
        y = 0.5 * (box_px[p, 1] + box_px[p, 3] - top - bottom)
        if x * x + y * y <= near_px * near_px:
            return False
    return True


@kernel
def found_people(xy_px, before_px, before_turns, width_px, height_px, box_px, turns):
    """Write where people are and how they lie in an image; tell who is found no more.

    Parameters
    ----------
    xy_px
        Their key points, (person, joint, 2), NaN where not shown.
    before_px, before_turns
        Boxes (before, 4) and turns (before,) of the people found before.
    width_px, height_px
        Size of the image.
    box_px
        Result, (person, 4): left, top, right, bottom.
    turns
        Result, (person,): by how many quarter turns counter-clockwise the image has to be turned
        for each of them to be upright.

    Returns
    -------
    wide, high
        The largest share of the image's width and height that somebody covers.
    turned
        Bit t is set if somebody needs t turns.
    lost
        0: nobody was lost; 1: somebody was; 2: somebody who was lying.
    """
    wide = high = 0.0
    turned = lost = 0
    for p in range(xy_px.shape[0]):
        enclose(xy_px, p, box_px)
        turns[p] = turn_upright(xy_px, p)
        turned |= 1 << turns[p]
        wide = max(wide, (box_px[p, 2] - box_px[p, 0]) / width_px)
        high = max(high, (box_px[p, 3] - box_px[p, 1]) / height_px)
    for b in range(before_px.shape[0]):
        if is_lost(before_px, b, box_px, width_px, height_px):
            lost = max(lost, 1 + before_turns[b] % 2)
    return wide, high, turned, lost
