"""Re-identification: a person who comes back soon after death gets the old identity."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.tuning import (
    ALONE_S,
    EXTRAPOLATE_S,
    REIDENTIFY_M,
    REIDENTIFY_MPS,
    TORN_VIEWS,
    UNSEEN_M,
    UNSEEN_MPS,
    YOUNG_MPS,
    YOUNG_S,
)


@dataclass(frozen=True, slots=True, eq=False)
class LostTrack:
    """A track that no camera supports, dead or not, and whose person may appear elsewhere.

    Attributes
    ----------
    id
        The identity.
    t_s
        When a camera last supported it [s].
    xyz_m, velocity_mps
        Position and velocity of the torso then.
    reach_mps
        How far its velocity may be off.
    alone_s
        For how long one camera alone had supported it then [s].
    """

    id: int
    t_s: float
    xyz_m: Float64[np.ndarray, "3"]
    velocity_mps: Float64[np.ndarray, "3"]
    reach_mps: float = UNSEEN_MPS
    alone_s: float = 0.0

    def distance_m(self, xyz_m: Float64[np.ndarray, "3"], t_s: float) -> float:
        """Return the distance of `xyz_m` from where the person may be at `t_s`.

        That is the line from the last position, had the person stopped at once, to the position
        extrapolated for up to `EXTRAPOLATE_S`.
        """
        way_m = self.velocity_mps * min(t_s - self.t_s, EXTRAPOLATE_S)
        length_m2 = float(way_m @ way_m)
        share = float((xyz_m - self.xyz_m) @ way_m) / length_m2 if length_m2 > 0.0 else 0.0
        return float(np.linalg.norm(xyz_m - self.xyz_m - min(max(share, 0.0), 1.0) * way_m))

    def velocity_to(self, xyz_m: Float64[np.ndarray, "3"], t_s: float) -> Float64[np.ndarray, "3"]:
        """Return the velocity of the person [m/s], who has been found at `xyz_m` at `t_s`.

        It is the way since the person was seen last, as far as that exceeds the error of a place.
        """
        since_s = t_s - self.t_s
        trust = since_s / ((self.reach_mps * since_s) ** 2 + UNSEEN_M**2) * self.reach_mps**2
        return np.asarray((xyz_m - self.xyz_m) * trust)


def reidentify(
    dead: list[LostTrack], xyz_m: Float64[np.ndarray, "3"], t_s: float, reidentify_s: float
) -> LostTrack | None:
    """Return the dead track nearest to a new one whose torso is at `xyz_m`; None if none is near.

    Parameters
    ----------
    dead
        Candidates.
    xyz_m, t_s
        Position of the new track's torso, and the time [s].
    reidentify_s
        Tracks that have been dead for longer do not count [s].
    """
    near = [
        (one.distance_m(xyz_m, t_s), one)
        for one in within(dead, t_s, reidentify_s)
        if one.distance_m(xyz_m, t_s)
        < REIDENTIFY_M + REIDENTIFY_MPS * (t_s - one.t_s + min(one.alone_s, ALONE_S))
    ]
    return min(near, key=lambda pair: pair[0])[1] if near else None


def within(dead: list[LostTrack], t_s: float, reidentify_s: float) -> list[LostTrack]:
    """Return the tracks that have been dead for no longer than `reidentify_s` at `t_s`."""
    return [one for one in dead if t_s - one.t_s <= reidentify_s]


def nearest_unseen(
    alive: list[LostTrack], xyz_m: Float64[np.ndarray, "3"], t_s: float
) -> LostTrack | None:
    """Return the living track whose person may have moved to `xyz_m`; None if there is none.

    Parameters
    ----------
    alive
        Tracks that no detection of the frame set supports.
    xyz_m, t_s
        Position of a new track's torso, and the time [s].

    Notes
    -----
    Prediction and gate follow steady motion. At the impact of a fall the trunk stops within one
    image: at 8 images per second, 0.4 m from the prediction in all cameras at once. The detections
    then begin a track that is the same person.
    """
    near = [
        (away_m, one)
        for one in alive
        if (away_m := one.distance_m(xyz_m, t_s)) < UNSEEN_M + one.reach_mps * (t_s - one.t_s)
    ]
    return min(near, key=lambda pair: pair[0])[1] if near else None


class Identities:
    """Gives identities to new tracks; none is given to two people.

    Parameters
    ----------
    reidentify_s
        For how long after a track's death its identity may be given again, to the same person [s].
    first_id
        The first identity.

    Attributes
    ----------
    dead
        Tracks whose identities may be given again.
    """

    def __init__(self, reidentify_s: float, first_id: int = 0) -> None:
        self.dead: list[LostTrack] = []
        self._reidentify_s = reidentify_s
        self._next_id = first_id

    def returning(self, torso_m: Float64[np.ndarray, "3"], t_s: float) -> LostTrack | None:
        """Return the dead track whose person a new one at `torso_m` is; None if nobody's."""
        return reidentify(self.dead, torso_m, t_s, self._reidentify_s)

    def new(self) -> int:
        """Return an identity that nobody has had."""
        self._next_id += 1
        return self._next_id - 1

    def note_dead(self, tracks: list[LostTrack], t_s: float) -> None:
        """Remember the tracks that die at `t_s`, and forget those that died too long ago."""
        self.dead = within(self.dead, t_s, self._reidentify_s) + tracks


def lost_since(
    last_seen_s: Float64[np.ndarray, "track cam"],
    cam: Int64[np.ndarray, " member"],
    match: Int64[np.ndarray, "known view"],
    view_cam: Int64[np.ndarray, " view"],
    lately_s: Float64[np.ndarray, " cam"],
) -> Float64[np.ndarray, " track"]:
    """Return since when each track is lost to a new one beside it; -inf for those that are not [s].

    Parameters
    ----------
    last_seen_s
        When each camera last supported each track [s]; tracks that are newer than the frame set
        come last, and are not lost.
    cam
        The cameras of the new track's detections.
    match, view_cam
        Detection of each track in each image of the frame set or -1, and the images' cameras.
    lately_s
        Since when a camera's support counts as now [s].

    Notes
    -----
    A track is lost if no detection supports it in this frame set; or if two cameras of the new
    track supported it until the last image, and none of the new track's cameras shows it now: then
    the same motion was within the gate of the other cameras' earlier images, or along their rays.
    """
    out = np.full(len(last_seen_s), -np.inf)
    last_seen_s = last_seen_s[: len(match)]
    unseen = (match < 0).all(axis=1)
    gone_here = (match[:, np.isin(view_cam, cam)] < 0).all(axis=1)
    until_now = (last_seen_s[:, cam] > lately_s[cam]).sum(axis=1)
    torn = gone_here & (until_now >= min(TORN_VIEWS, len(cam)))
    since_s = np.where(unseen, last_seen_s.max(axis=1), last_seen_s[:, cam].max(axis=1))
    out[: len(match)] = np.where(unseen | torn, since_s, -np.inf)
    return out


def lost_tracks(
    people: Population,
    seen_s: Float64[np.ndarray, " track"],
    grid: KnotGrid,
    model: Model,
    t_s: float,
) -> list[LostTrack]:
    """Return what re-identification needs of tracks, as they were at the times `seen_s`.

    Those of which the time is -inf are left out. `t_s` is the time of the last frame set.
    """
    lost = []
    for k in np.flatnonzero(np.isfinite(seen_s)).tolist():
        then_s = max(float(seen_s[k]), t_s - model.settings.window_s)
        motion = np.empty((2, 3))
        kernels.torso_motion(people.c[k], model.torso, grid.knot_time(then_s), grid.knot_s, motion)
        known = then_s - people.born_s[k] > YOUNG_S
        reach_mps = UNSEEN_MPS if known else YOUNG_MPS
        alone_s = max(then_s - float(people.last_two_view_s[k]), 0.0)
        lost.append(LostTrack(int(people.id[k]), then_s, motion[0], motion[1], reach_mps, alone_s))
    return lost
