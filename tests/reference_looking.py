"""Slow, obvious twins of the kernels of the looks."""

import numpy as np

SHOULDERS, HIPS, KNEES, ANKLES = (5, 6), (11, 12), (13, 14), (15, 16)


def box(xy_px):
    """The box around the known key points of one person: left, top, right, bottom."""
    return np.concatenate([np.nanmin(xy_px, axis=0), np.nanmax(xy_px, axis=0)])


def turn_upright(xy_px):
    """How many quarter turns counter-clockwise the image needs for one person to be upright."""
    middle = {pair: xy_px[list(pair)] for pair in (SHOULDERS, HIPS, KNEES, ANKLES)}
    known = {pair: two[np.isfinite(two[:, 0])] for pair, two in middle.items()}
    below = [known[pair].mean(axis=0) for pair in (ANKLES, KNEES, HIPS) if len(known[pair])]
    if not len(known[SHOULDERS]) or not below:
        return 0
    right, down = known[SHOULDERS].mean(axis=0) - below[0]
    if abs(right) > abs(down):
        return 1 if right > 0 else 3
    return 2 if down > 0 else 0


def is_lost(before_px, box_px, size_px):
    """Whether nobody is near where somebody was, who was not near a border of the image."""
    size_px = np.array(size_px)
    if (before_px[:2] <= 0.05 * size_px).any() or (before_px[2:] >= 0.95 * size_px).any():
        return False
    extent_px = (before_px[2:] - before_px[:2]).max()
    middle_px = (before_px[:2] + before_px[2:]) / 2
    away_px = [np.linalg.norm((one[:2] + one[2:]) / 2 - middle_px) for one in box_px]
    return all(away > 0.7 * extent_px for away in away_px)
