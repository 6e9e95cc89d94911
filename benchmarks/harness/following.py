"""Tracks beside the truth, joint by joint at every moment, to be cut into parts as one likes."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from harness.options import settings_from

if TYPE_CHECKING:
    from trecsim.geometry import Rig
    from trecsim.store.truth import Truth
    from trecsim.values import Poses2D

NEAR_M = 0.15
Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """What became of everybody in the truth.

    Attributes
    ----------
    t_s
        The moments, (moment,) [s].
    truth_m
        Where everybody truly was, NaN while absent, (person, moment, joint, 3) [m].
    found_m
        Where the tracks have the same person, NaN while missed [m].
    sigma_m
        How sure they are of it, (person, moment, joint) [m].
    support
        By how many cameras, -1 while missed, (person, moment, joint).
    identity
        Which identity that was, -1 while missed, (person, moment).
    """

    t_s: Array
    truth_m: Array
    found_m: Array
    sigma_m: Array
    support: npt.NDArray[np.int64]
    identity: npt.NDArray[np.int64]

    @property
    def there(self) -> Flags:
        """Who was truly there, (person, moment)."""
        known: Flags = np.isfinite(self.truth_m[:, :, 0, 0])
        return known

    @property
    def error_m(self) -> Array:
        """How far each joint is off, NaN while absent or missed, (person, moment, joint)."""
        off_m: Array = np.linalg.norm(self.found_m - self.truth_m, axis=-1)
        return off_m

    @property
    def switched(self) -> Flags:
        """Whether a person bears another identity than when last found, (person, moment)."""
        out = np.zeros(self.identity.shape, np.bool_)
        for person, identity in enumerate(self.identity):
            when = np.flatnonzero(identity >= 0)
            out[person, when[1:]] = np.diff(identity[when]) != 0
        return out


def followed(
    poses: "Iterable[Poses2D]", rig: "Rig", truth: "Truth", overrides: Mapping[str, object]
) -> Followed:
    """Track without lag, and lay the tracks beside the truth.

    Parameters
    ----------
    poses
        Images in order of arrival.
    rig
        The cameras.
    truth
        Known at all times.
    overrides
        Settings of the fusion that differ from their defaults.
    """
    from trecsim.lab.evaluation.moments import gather, within
    from trecsim.lab.evaluation.truth_matching import NOBODY, Matcher, nearness, truth_at
    from trecsim.tracking import follow

    snapshots = follow(poses, rig, settings_from(overrides))
    moments = within(gather(snapshots), float(truth.t_s[0]), float(truth.t_s[-1]))
    matcher = Matcher(moments, truth)
    for near in nearness(moments, truth):
        matcher.add(near)
    row = matcher.result().row.T
    found = row != NOBODY
    truth_m = truth_at(moments.t_s, truth)
    shape = truth_m.shape[:3]
    found_m, sigma_m = np.full((*shape, 3), np.nan), np.full(shape, np.nan)
    support, identity = np.full(shape, -1), np.full(shape[:2], -1)
    found_m[found] = moments.xyz_m[row[found]]
    sigma_m[found] = moments.sigma_m[row[found]]
    support[found] = moments.support[row[found]]
    identity[found] = moments.id[row[found]]
    return Followed(moments.t_s, truth_m, found_m, sigma_m, support, identity)


def errors(one: Followed, part: Flags) -> dict[str, float]:
    """Return how far joints are off, and how many were found, in a part of what was followed.

    Parameters
    ----------
    one
        Tracks beside the truth.
    part
        The joints that count, (person, moment, joint); those of people who are absent never do.
    """
    part = part & one.there[:, :, None]
    off_cm = 100 * one.error_m[part]
    found = np.isfinite(off_cm)
    some_cm = off_cm[found] if found.any() else np.full(1, np.nan)
    people = part.any(axis=2)
    missed = people & (one.identity < 0)
    return {
        "mean error": float(some_cm.mean()),
        "p95 error": float(np.quantile(some_cm, 0.95)),
        "joints within 15 cm": share(int((some_cm <= 100 * NEAR_M).sum()), len(off_cm)),
        "missed": 100 * share(int(missed.sum()), int(people.sum())),
        "switches": float((one.switched & people).sum()),
    }


def share(part: int, whole: int) -> float:
    """Return a part as a share of the whole, NaN of nothing."""
    return part / whole if whole else float("nan")
