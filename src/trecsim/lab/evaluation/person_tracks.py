"""Tracks person by person, as arrays over time."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float64, Int16, Int64

from trecsim.lab.evaluation.moments import Moments

GAP_PERIODS = 1.5  # of the typical period; a longer step is a gap


@dataclass(frozen=True, slots=True, eq=False)
class PersonTrack:
    """Track of one identity.

    Attributes
    ----------
    person
        The identity.
    t_s
        Times of its frames, increasing [s].
    xyz_m
        Joints in the world frame; NaN where unknown [m].
    support
        Number of cameras that support each joint; 0 means predicted.
    """

    person: int
    t_s: Float64[np.ndarray, " time"]
    xyz_m: Float[np.ndarray, "time joint 3"]
    support: Int16[np.ndarray, "time joint"]


def people_of(moments: Moments) -> tuple[PersonTrack, ...]:
    """Return all tracks in order of identity."""
    order = np.argsort(moments.id, kind="stable")
    identity, first = np.unique(moments.id[order], return_index=True)
    t_s = moments.t_s[moments.moment[order]]
    xyz_m, support = moments.xyz_m[order], moments.support[order]
    edges = np.append(first, len(order))
    return tuple(
        PersonTrack(int(person), t_s[rows], xyz_m[rows], support[rows])
        for person, rows in zip(identity, map(slice, edges, edges[1:]), strict=False)
    )


def pieces(t_s: Float64[np.ndarray, " time"], usual_s: float) -> Int64[np.ndarray, " time"]:
    """Return for each frame of a track the number of the uninterrupted piece it belongs to.

    Examples
    --------
    >>> pieces(np.array([0.0, 0.04, 0.08, 0.2, 0.24]), 0.04)
    array([0, 0, 0, 1, 1])
    """
    return np.cumsum(np.diff(t_s, prepend=t_s[:1]) > GAP_PERIODS * usual_s)


def mean_of_known(values: Float64[np.ndarray, "..."], axis: int) -> Float64[np.ndarray, "..."]:
    """Return the mean over one axis of the values that are not NaN; NaN without any.

    Examples
    --------
    >>> mean_of_known(np.array([[1.0, np.nan, 3.0], [np.nan, np.nan, np.nan]]), axis=1)
    array([ 2., nan])
    """
    known = np.isfinite(values)
    count = known.sum(axis=axis)
    total = np.where(known, values, 0.0).sum(axis=axis)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)
