"""Tracks beside the truth with all that they claim: covariance, support, state; and ghosts."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from harness import regions
from harness.body_parts import LIMBS
from harness.options import settings_from
from trecsim.lab.evaluation.moments import Moments, gather
from trecsim.lab.evaluation.truth_matching import NOBODY, Matcher, nearness, truth_at
from trecsim.store.truth import Truth
from trecsim.tracking import Follower, Tally

if TYPE_CHECKING:
    from trecsim.geometry import Rig
    from trecsim.values import Poses2D, Snapshot

AWAY_S = 1.0  # who is out of all views for less did not leave
LEAST_JOINTS = 5  # inside an image, for a person to be in view there
SUPPORTS = {"support 0": 0, "support 1": 1, "support 2": 2, "support 3+": 3}
Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Numbers = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Ghosts:
    """Tracks at moments at which they are nobody's.

    Attributes
    ----------
    t_s, identity
        When, and which track, (ghost,).
    owner
        Whose it was when it last was somebody's, -1 if it never was, (ghost,).
    """

    t_s: Array
    identity: Numbers
    owner: Numbers


@dataclass(frozen=True, slots=True, eq=False)
class Beside:
    """What is said of everybody in the truth; NaN and -1 where nothing is.

    Attributes
    ----------
    t_s
        The moments, (moment,).
    truth_m, found_m
        Where they were, and are said to be, (person, moment, joint, 3).
    cov_m2
        Its covariance, (person, moment, joint, 3, 3).
    support
        Of each joint, (person, moment, joint).
    identity
        Of the track, (person, moment).
    ghosts
        Tracks that are nobody's.
    """

    t_s: Array
    truth_m: Array
    found_m: Array
    cov_m2: Array
    support: Numbers
    identity: Numbers
    ghosts: Ghosts

    @property
    def there(self) -> Flags:
        """Who was truly there, (person, moment)."""
        out: Flags = np.isfinite(self.truth_m[..., 0]).any(axis=-1)
        return out

    @property
    def error_m(self) -> Array:
        """How far each joint is off, (person, moment, joint)."""
        out: Array = np.linalg.norm(self.found_m - self.truth_m, axis=-1)
        return out

    @property
    def missed(self) -> int:
        """Number of person-moments without a track."""
        return int((self.there & (self.identity < 0)).sum())

    @property
    def switches(self) -> int:
        """How often somebody bears another identity than when last found."""
        known = (row[row >= 0] for row in self.identity)
        return int(sum((np.diff(row) != 0).sum() for row in known))

    @property
    def leavers(self) -> int:
        """Number of ghosts whose people are no longer there at all."""
        moment = np.searchsorted(self.t_s, self.ghosts.t_s)
        owned = self.ghosts.owner >= 0
        return int((~self.there[self.ghosts.owner[owned], moment[owned]]).sum())

    def errors(self, chosen: Flags | None = None) -> regions.Errors:
        """Return errors and covariances of all joints found, or of some [cm]."""
        known = np.isfinite(self.error_m)
        known = known if chosen is None else known & chosen
        off_cm = 100 * (self.found_m - self.truth_m)[known]
        return regions.Errors(off_cm, 1e4 * self.cov_m2[known])

    def limbs_too_long(self, times: float) -> tuple[int, int]:
        """Return how many limbs are longer than so many times the true one, and of how many."""
        one, other = np.array(LIMBS).T
        said, true = (
            np.linalg.norm(m[:, :, one] - m[:, :, other], axis=-1)
            for m in (self.found_m, self.truth_m)
        )
        known = np.isfinite(said) & np.isfinite(true)
        return int((said[known] > times * true[known]).sum()), int(known.sum())


def said(
    poses: "Iterable[Poses2D]",
    rig: "Rig",
    overrides: Mapping[str, object],
    lag_s: float = 0.0,
    *,
    provisional: bool = False,
    remark: Callable[[str, float], None] = lambda text, t_s: None,
) -> "Iterator[Snapshot]":
    """Yield what the tracker says, provisional people included if asked for.

    Parameters
    ----------
    poses, rig
        What it is given.
    overrides
        Settings of the fusion that differ from their defaults.
    lag_s
        How far behind the newest image [s].
    provisional
        Whether those are reported whom it is not sure of yet.
    remark
        Is told what is said of poses and rig that do not fit, and the time of the images [s].
    """
    tally = Tally()
    follower = Follower(
        rig, settings_from(overrides), lag_s=lag_s, tally=tally, provisional=provisional
    )
    told = 0
    for image in poses:
        yield from follower.add(image)
        for text in tally.remarks[told:]:
            remark(text, image.t_s)
        told = len(tally.remarks)
    yield from follower.flush()


def beside(snapshots: "Iterable[Snapshot]", truth: Truth) -> Beside:
    """Lay what is said beside the truth, which is known from its first to its last moment."""
    from_s, until_s = float(truth.t_s[0]), float(truth.t_s[-1])
    some = [one for one in snapshots if from_s - 1e-6 <= one.t_s <= until_s + 1e-6]
    moments = gather(some)
    matcher = Matcher(moments, truth)
    for near in nearness(moments, truth):
        matcher.add(near)
    row = matcher.result().row.T
    found = row != NOBODY
    truth_m = truth_at(moments.t_s, truth)
    shape = truth_m.shape[:3]
    cov_m2 = np.concatenate([one.cov_m2 for one in some])
    out = Beside(
        moments.t_s, truth_m, np.full((*shape, 3), np.nan), np.full((*shape, 3, 3), np.nan),
        np.full(shape, -1), np.full(shape[:2], -1), _ghosts(moments, row),
    )  # fmt: skip
    out.found_m[found] = moments.xyz_m[row[found]]
    out.cov_m2[found] = cov_m2[row[found]]
    out.support[found] = moments.support[row[found]]
    out.identity[found] = moments.id[row[found]]
    return out


def _ghosts(moments: Moments, row: Numbers) -> Ghosts:
    whose = np.full(len(moments.id), -1)
    person, moment = np.nonzero(row != NOBODY)
    whose[row[person, moment]] = person
    last: dict[int, int] = {}
    owner = np.full(len(whose), -1)
    for n, (identity, person_) in enumerate(zip(moments.id.tolist(), whose.tolist(), strict=True)):
        if person_ >= 0:
            last[identity] = person_
        owner[n] = last.get(identity, -1)
    nobody = whose < 0
    return Ghosts(moments.t_s[moments.moment[nobody]], moments.id[nobody], owner[nobody])


class Left(NamedTuple):
    """How long a track lives on after its person left all views [s], and whether by walking out.

    Simulated people may also end in the middle of a view, where no real person can.
    """

    after_s: float
    walked_out: bool


def left(one: Beside, rig: "Rig") -> list[Left]:
    """Return what became of the tracks of all who left all views for a second or more.

    Somebody is in view where at least `LEAST_JOINTS` joints are inside the image of some camera.
    """
    seen = in_view(one, rig)
    out = []
    for person, identity in enumerate(one.identity):
        for moment in np.flatnonzero(seen[person, :-1] & ~seen[person, 1:]):
            again = np.flatnonzero(seen[person, moment + 1 :])
            until = moment + 1 + again[0] if len(again) else len(one.t_s)
            after = one.t_s[moment + 1 : until]
            if identity[moment] >= 0 and after[-1] - after[0] > AWAY_S:
                lived = _lived(one, person, int(identity[moment]), after)
                after_s = float(lived - one.t_s[moment]) if lived else 0.0
                out.append(Left(after_s, bool(one.there[person, moment + 1])))
    return out


def _lived(one: Beside, person: int, identity: int, after_s: Array) -> float:
    """Return the last of these times at which a track of this identity exists, 0 if none does."""
    held = one.identity[person, np.searchsorted(one.t_s, after_s)] == identity
    as_ghost = one.ghosts.t_s[one.ghosts.identity == identity]
    exists = held | np.isin(after_s, as_ghost)
    gone = np.flatnonzero(~exists)
    last = (gone[0] if len(gone) else len(after_s)) - 1
    return float(after_s[last]) if last >= 0 else 0.0


def in_view(one: Beside, rig: "Rig") -> Flags:
    """Return who is truly in the view of any camera, (person, moment)."""
    seen: Flags = np.zeros(one.there.shape, bool)
    for camera in rig:
        with np.errstate(invalid="ignore"):
            xy_px = camera.project(one.truth_m)
            inside = ((xy_px >= 0) & (xy_px <= np.array(camera.size_px))).all(axis=-1)
        seen |= inside.sum(axis=-1) >= LEAST_JOINTS
    return seen


def by_support(one: Beside) -> dict[str, Flags]:
    """Return the joints of each support."""
    return {
        name: (one.support >= least) if name.endswith("+") else (one.support == least)
        for name, least in SUPPORTS.items()
    }
