"""Key points at given stamps: lines through the images near in time."""

import math

import numpy as np

from trecsim.calibrating.people.tuning import STRAY, WINDOW_S
from trecsim.compiler import inner, kernel


@kernel(allocates=True)
def sample(t_s, xy, size, stamps_s, place, speed):
    """Write where the joints of a tracklet are at given stamps, and how fast they move.

    Parameters
    ----------
    t_s, xy, size
        Stamps, key points and extents of the tracklet's detections, in order.
    stamps_s
        Where the joints are wanted, increasing [s].
    place, speed
        (stamp, joint, 2), changed in place; NaN where fewer than two images show a joint.
    """
    begin = 0
    kept = np.empty(t_s.shape[0], np.bool_)
    for i in range(stamps_s.shape[0]):
        while begin < t_s.shape[0] and t_s[begin] < stamps_s[i] - WINDOW_S:
            begin += 1
        end = begin
        while end < t_s.shape[0] and t_s[end] <= stamps_s[i] + WINDOW_S:
            end += 1
        for j in range(xy.shape[1]):
            for k in range(begin, end):
                kept[k] = xy[k, j, 0] == xy[k, j, 0]
            line(t_s, xy[:, j], kept, begin, end, stamps_s[i], place[i, j], speed[i, j])
            strays = 0
            for k in range(begin, end):
                if kept[k]:
                    ahead = t_s[k] - stamps_s[i]
                    x = xy[k, j, 0] - place[i, j, 0] - ahead * speed[i, j, 0]
                    y = xy[k, j, 1] - place[i, j, 1] - ahead * speed[i, j, 1]
                    if not math.sqrt(x * x + y * y) < STRAY * size[k]:
                        kept[k] = False
                        strays += 1
            if strays > 0:
                line(t_s, xy[:, j], kept, begin, end, stamps_s[i], place[i, j], speed[i, j])


@inner
def line(t_s, xy, kept, begin, end, at_s, place, speed):
    """Write the line through the images that are kept: its place and slope.

    Weights fall to nothing at the window's edge (Epanechnikov). With equal weights an image that
    enters or leaves the window changes how much the line cuts off a swinging limb's way, so that
    cameras that take their images at other moments would seem late.
    """
    n = 0
    total = t = tt = 0.0
    for k in range(begin, end):
        if kept[k]:
            ahead = t_s[k] - at_s
            w = 1.0 - (ahead / WINDOW_S) ** 2
            n, total, t, tt = n + 1, total + w, t + w * ahead, tt + w * ahead * ahead
    det = total * tt - t * t
    for a in range(2):
        place[a] = speed[a] = math.nan
        if n < 2 or not det > 1e-9:
            continue
        z = tz = 0.0
        for k in range(begin, end):
            if kept[k]:
                ahead = t_s[k] - at_s
                w = 1.0 - (ahead / WINDOW_S) ** 2
                z += w * xy[k, a]
                tz += w * ahead * xy[k, a]
        speed[a] = (total * tz - t * z) / det
        place[a] = (z - speed[a] * t) / total
