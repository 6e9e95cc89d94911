"""Moments common to videos of a board: corners are taken between the images of each camera."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.boards import Board
from trecsim.calibrating.corner_sights import Sight, posed
from trecsim.calibrating.corners import SeenBoard
from trecsim.calibrating.views import CameraViews, View
from trecsim.geometry.camera import Camera

LONGEST_GAP_S = 0.17  # between views, for corners to be taken in between
MOST_MOMENTS = 160
LEAST_CORNERS = 6
GRID_MOMENTS = 1200


@dataclass(frozen=True, slots=True, eq=False)
class TimedViews:
    """The views of one board by one camera, with poses.

    Attributes
    ----------
    camera, board
        Numbers.
    t_s
        Stamps of the camera [s], increasing.
    views
        The views.
    poses
        Pose of the board before the camera in each.
    """

    camera: int
    board: int
    t_s: Float64[np.ndarray, " view"]
    views: tuple[View, ...]
    poses: Float64[np.ndarray, "view 4 4"]


def _sorted(seen: SeenBoard) -> SeenBoard:
    order = np.argsort(seen.ids)
    return SeenBoard(seen.ids[order], seen.xy_px[order], seen.edge_px)


def timed_views(
    cameras: Sequence[Camera], views: Sequence[Sequence[CameraViews]], boards: Sequence[Board]
) -> list[TimedViews]:
    """Return the views of videos with poses, one entry per camera and board."""
    found = []
    for number, (board, of_board) in enumerate(zip(boards, views, strict=True)):
        for index, (camera, of_camera) in enumerate(zip(cameras, of_board, strict=True)):
            ordered = [replace(view, seen=_sorted(view.seen)) for view in of_camera.views]
            rows = [(view, posed(camera, board, view.seen)) for view in ordered]
            kept = [(view, T) for view, T in rows if T is not None]
            found.append(
                TimedViews(
                    index,
                    number,
                    np.array([view.t_s for view, _ in kept]),
                    tuple(view for view, _ in kept),
                    np.array([T for _, T in kept]).reshape(-1, 4, 4),
                )
            )
    return found


def sights_at_moments(
    cameras: Sequence[Camera],
    timed: Sequence[TimedViews],
    boards: Sequence[Board],
    offset_s: Float64[np.ndarray, " cam"],
    most: int = MOST_MOMENTS,
) -> list[Sight]:
    """Return what all cameras saw in common moments, corners being taken between two images.

    Parameters
    ----------
    cameras, timed, boards
        What was seen.
    offset_s
        What to add to the stamps of each camera [s].
    most
        Largest number of moments: those in which most cameras see the board and it moves least.
    """
    spans = [one.t_s + offset_s[one.camera] for one in timed if len(one.t_s)]
    start, end = min(t[0] for t in spans), max(t[-1] for t in spans)
    times = np.linspace(start, end, min(GRID_MOMENTS, max(int((end - start) * 30), 2)))
    rows: dict[int, list[tuple[TimedViews, int, float]]] = {}
    for one in timed:
        for moment, place, share in _between(one, times - offset_s[one.camera]):
            rows.setdefault(moment, []).append((one, place, share))
    chosen = _worth(rows, most)
    sights = []
    for number, moment in enumerate(chosen):
        for one, place, share in rows[moment]:
            sight = _interpolated(one, place, share, number, cameras, boards)
            if sight is not None:
                sights.append(sight)
    return sights


def _between(
    one: TimedViews, stamps: Float64[np.ndarray, " moment"]
) -> list[tuple[int, int, float]]:
    """Return for each moment that lies between two near views its number, place and share."""
    t = one.t_s
    if len(t) < 2:
        return []
    after = np.searchsorted(t, stamps)
    inside = (after > 0) & (after < len(t))
    rows = []
    for moment in np.flatnonzero(inside):
        place = int(after[moment]) - 1
        gap = float(t[place + 1] - t[place])
        if gap <= LONGEST_GAP_S:
            rows.append((int(moment), place, float((stamps[moment] - t[place]) / gap)))
    return rows


def _worth(rows: dict[int, list[tuple[TimedViews, int, float]]], most: int) -> list[int]:
    """Return the moments to use: spread in time, of each stretch the one that tells most."""
    shared = sorted(m for m, seen in rows.items() if len({one.camera for one, _, _ in seen}) > 1)
    if len(shared) <= most:
        return shared
    worth = {
        moment: (
            len({one.camera for one, _, _ in rows[moment]}),
            -max(_motion_px(one, place) for one, place, _ in rows[moment]),
        )
        for moment in shared
    }
    stretches = np.array_split(np.array(shared), most)
    return [max(stretch.tolist(), key=lambda m: worth[m]) for stretch in stretches]


def _motion_px(one: TimedViews, place: int) -> float:
    a, b = one.views[place].seen, one.views[place + 1].seen
    return float(np.linalg.norm(a.xy_px.mean(axis=0) - b.xy_px.mean(axis=0)))


def _interpolated(
    one: TimedViews,
    place: int,
    share: float,
    moment: int,
    cameras: Sequence[Camera],
    boards: Sequence[Board],
) -> Sight | None:
    """Return the corners between two images, by the cubic through the two before and after."""
    stamp = float(one.t_s[place] + share * (one.t_s[place + 1] - one.t_s[place]))
    around = [n for n in range(place - 1, place + 3) if 0 <= n < len(one.t_s)]
    around = [n for n in around if abs(one.t_s[n] - stamp) <= 2 * LONGEST_GAP_S]
    views = [one.views[n] for n in around]
    ids = views[around.index(place)].seen.ids
    for view in views:
        ids = np.intersect1d(ids, view.seen.ids)
    if len(ids) < LEAST_CORNERS:
        return None
    weight, slope = _cubic(one.t_s[around], stamp)
    xy = np.array([v.seen.xy_px[np.searchsorted(v.seen.ids, ids)] for v in views])
    seen = SeenBoard(ids, np.tensordot(weight, xy, axes=1), views[0].seen.edge_px)
    T = posed(cameras[one.camera], boards[one.board], seen)
    if T is None:
        return None
    velocity = np.tensordot(slope, xy, axes=1)
    label = one.views[place].label
    return Sight(one.camera, moment, one.board, label, ids, seen.xy_px, velocity, T)


def _cubic(
    t_s: Float64[np.ndarray, " view"], stamp_s: float
) -> tuple[Float64[np.ndarray, " view"], Float64[np.ndarray, " view"]]:
    """Return the weights of values at some times for the value and the slope at another.

    Notes
    -----
    Lagrange's polynomial through all of them: of the third degree for four. Straight lines between
    images would cut the corners of the board's path.
    """
    x = t_s - stamp_s
    scale = float(np.abs(x).max()) or 1.0
    powers = np.vander(x / scale, increasing=True)
    inverse_powers = np.linalg.inv(powers)
    return inverse_powers[0], inverse_powers[1] / scale
