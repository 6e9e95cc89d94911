"""People whom one camera alone sees: provisional tracks beside those that two cameras began.

They take only detections that no other track takes, and nothing of the other tracks depends on
them but the identity of a new one: so nobody whom two cameras see is worse off for them.
"""

from collections.abc import Callable, Collection
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion import evidence, fitting, kernels
from trecsim.fusion.association import away_m
from trecsim.fusion.birth import Candidate
from trecsim.fusion.fitting import Step, Update
from trecsim.fusion.images import Detections, Images
from trecsim.fusion.initialisation import Birth, completed, first_states, own_detections
from trecsim.fusion.kernels import Ranges
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.tuning import (
    CROWDED,
    LONGEST_STEP_S,
    MISSED_PATIENCE,
    MOST_RANGE_SIGMA,
    MOST_SINGLE_VIEWS,
    OCCUPIED_M,
    SINGLE_VIEW_PATIENCE_S,
    SINGLE_VIEW_S,
    VACANT_M,
)

NOBODY = -1


class Company(NamedTuple):
    """The tracks that two cameras began, as far as those of a single camera heed them.

    Attributes
    ----------
    xyz_m
        Their joints [m].
    match
        The detection of each image that belongs to each, or -1; tracks that are newer than the
        association are not in it.
    look_back_s
        For how long what each camera supported counts as supported now [s].
    """

    xyz_m: Float64[np.ndarray, "track joint 3"]
    match: Int64[np.ndarray, "known view"]
    look_back_s: Float64[np.ndarray, " cam"]


class SingleViews:
    """The tracks of people whom one camera alone has seen so far.

    Attributes
    ----------
    people
        The tracks; the identity is `NOBODY` before they are reported.
    model
        Constants of the run.
    support_s
        For how long each has been supported, by the quality of its detections [s].
    """

    def __init__(self, model: Model, live: int) -> None:
        self.model = model
        self.people = Population.empty(
            len(model.skeleton.joints), live, len(model.rig), len(model.body.joints)
        )
        self.support_s: Float64[np.ndarray, " track"] = np.empty(0)
        self._key: Int64[np.ndarray, " track"] = np.empty(0, np.int64)
        self._next_key = 0

    def __len__(self) -> int:
        """Return the number of tracks."""
        return len(self.people)

    def take(
        self, images: Images, update: Update, step: Step
    ) -> Int64[np.ndarray, " person"] | None:
        """Take the detections that are nobody's into the tracks, in place.

        Return which track each detection of `images` supports: its key, or `NOBODY`; None if there
        are no tracks.
        """
        if not len(self):
            return None
        claim = np.full(len(images.xy_px), NOBODY)
        free = update.owner == kernels.FREE
        found = fitting.update(
            self.people, images.only(free), step, self.model, check=False, is_single=True
        )
        if found.is_mirrored:
            evidence.unmirror(self.people, self.model)
        match = found.association.match
        track, view = np.nonzero(match >= 0)
        row = np.flatnonzero(free)[match[track, view]]
        claim[row] = self._key[track]
        since_s = np.array(step.since_s)[view]
        taken = images.detections(np.ones(len(claim), bool), claim).take(row)
        np.add.at(self.support_s, track, _worth_s(taken, since_s))
        return claim

    def rows(self, claim: Int64[np.ndarray, " some"]) -> list[int]:
        """Return the tracks that detections support by their claims."""
        keys = set(claim.tolist()) - {NOBODY}
        return [k for k, key in enumerate(self._key.tolist()) if key in keys] if keys else []

    def begin(
        self,
        found: Detections,
        images: Images,
        company: Company,
        level: tuple[float, float],
        step: Step,
        grid: KnotGrid,
    ) -> None:
        """Begin tracks from detections that no track explains, up to `MOST_SINGLE_VIEWS`.

        `level` is the height of the ground under somebody new, and its variance [m, m^2].
        """
        if len(self) >= MOST_SINGLE_VIEWS:
            return
        found = found.take(~self._explained(found, images, company))
        found = found.take(found.best(MOST_SINGLE_VIEWS - len(self)))
        if not len(found):
            return
        ranges, agrees, at_one_m = first_ranges(found, level, self.model)
        good = (ranges.cov[:, 0, 0] < MOST_RANGE_SIGMA**2) & agrees
        if not good.any():
            return
        found, ranges = found.take(good), Ranges(*(values[good] for values in ranges))
        new = self._first_states(found, ranges, at_one_m[good], step, grid)
        new.ground_level[:] = level
        since_s = dict(zip(images.cam.tolist(), step.since_s, strict=True))
        worth_s = _worth_s(found, np.array([since_s[cam] for cam in found.cam.tolist()]))
        self.people = self.people.joined(new)
        self.support_s = np.append(self.support_s, worth_s)
        self._key = np.append(self._key, self._next_key + np.arange(len(new)))
        self._next_key += len(new)

    def _first_states(
        self,
        found: Detections,
        ranges: Ranges,
        at_one_m: Float64[np.ndarray, "person joint 3"],
        step: Step,
        grid: KnotGrid,
    ) -> Population:
        """Return tracks upright at their distances, fitted to their detections."""
        m = self.model
        origin_m = m.cameras.position_m[ranges.cam]
        xyz_m = origin_m[:, None] + np.exp(ranges.mean[:, 0])[:, None, None] * at_one_m
        none = np.zeros(1, np.int64)
        alone = [Candidate(np.array([d]), none, xyz_m[d], sure=False) for d in range(len(found))]
        births = [
            Birth(candidate, place_m, NOBODY, confirmed=False, velocity_mps=np.zeros(3))
            for candidate, place_m in zip(alone, completed(alone, m), strict=True)
        ]
        new = first_states(births, step.now.t_s, grid, m)
        shown, association = own_detections(births, found)
        # As if the last images were long ago: the first place is known across the rays only.
        now = Step(
            step.now._replace(elapsed_s=0.0),
            [np.inf] * len(shown),
            step.look_back_s,
            [False] * len(shown),
        )
        fitting.fit(new, shown, association, now, m)
        for mine, values in zip(new.ranges, ranges, strict=True):
            mine[:] = values
        return new

    def _explained(
        self, found: Detections, images: Images, company: Company
    ) -> Bool[np.ndarray, " person"]:
        """Return which detections show somebody who is followed already.

        Either a track near a detection has none of its own in that image, as it was badly read; or
        it has another one, and the detector found the person twice.
        """
        match = np.full((len(company.xyz_m), len(images)), 0)
        match[: len(company.match)] = company.match
        there_m = np.concatenate([company.xyz_m, self.people.xyz_m])
        near_m = np.full(len(there_m), VACANT_M)
        out = np.zeros(len(found), bool)
        for cam in set(found.cam.tolist()):
            vacant = (match[:, images.cam == cam] < 0).all(axis=1)
            near_m[: len(company.xyz_m)] = np.where(vacant, VACANT_M, OCCUPIED_M)
            mine = found.cam == cam
            out[mine] = (away_m(self.model, cam, there_m, found.xy_px[mine]) < near_m).any(axis=1)
        return out

    def dead(self, company: Company, t_s: float) -> Bool[np.ndarray, " track"]:
        """Return which tracks are dead."""
        if not len(self):
            return np.zeros(0, bool)
        people, s = self.people, self.model.settings
        unseen_s = t_s - people.last_seen_s.max(axis=1)
        least_s = np.maximum(SINGLE_VIEW_PATIENCE_S, company.look_back_s[people.range_cam])
        patience_s = np.maximum(np.minimum(self.support_s, s.death_s), least_s)
        return np.asarray(
            (unseen_s > patience_s) | ~np.isfinite(people.xyz_m).all(axis=(1, 2)), np.bool_
        )

    def due(self, company: Company, looking: Callable[[], Bool[np.ndarray, " cam"]]) -> list[int]:
        """Return the tracks that have been supported for long enough to be reported from now on.

        Each further camera that should see such a person, and does not, makes it longer. `looking`
        returns which cameras deliver images; it is called only if it matters.
        """
        is_new = (self.people.id == NOBODY) & (self.support_s >= SINGLE_VIEW_S)
        new = np.flatnonzero(is_new)
        if not len(new):
            return []
        missed_by = np.maximum(self._expected(company, looking(), is_new)[new] - 1, 0)
        enough = self.support_s[new] >= SINGLE_VIEW_S * MISSED_PATIENCE**missed_by
        due: list[int] = new[enough & (missed_by < CROWDED - 1)].tolist()
        return due

    def _expected(
        self,
        company: Company,
        looking: Bool[np.ndarray, " cam"],
        which: Bool[np.ndarray, " track"],
    ) -> Int64[np.ndarray, " track"]:
        """Return how many cameras should detect each of `which`, wherever on its rays it is.

        The distance may be off by one standard deviation to either side.
        """
        m, mine = self.model, self.people
        n = len(self) + len(company.xyz_m)
        asked = np.append(which, np.zeros(len(company.xyz_m), bool))
        found = np.zeros((3, n), np.int64)
        leaving, should = np.zeros(n, bool), np.zeros((n, len(m.rig)), bool)
        ray_m = mine.xyz_m - m.cameras.position_m[mine.range_cam, None]
        sigma = np.sqrt(mine.range_cov[:, 0, 0])
        for expected, way in zip(found, (-1.0, 0.0, 1.0), strict=True):
            there_m = mine.xyz_m + way * sigma[:, None, None] * ray_m
            xyz_m = np.concatenate([there_m, company.xyz_m])
            kernels.expect_all(
                m.lenses, m.silhouette, looking, m.torso, xyz_m, np.zeros((n, 3)), asked,
                kernels.Views(expected, leaving, should),
            )  # fmt: skip
        return np.asarray(found.min(axis=0)[: len(self)])

    def marked(self, rows: Collection[int]) -> Bool[np.ndarray, " track"]:
        """Return which tracks are among `rows`."""
        which = np.zeros(len(self), bool)
        which[list(rows)] = True
        return which

    def drop(self, which: Bool[np.ndarray, " track"]) -> None:
        """Delete the tracks `which`."""
        if which.any():
            self.people = self.people.keep(~which)
            self.support_s, self._key = self.support_s[~which], self._key[~which]


def _worth_s(
    found: Detections, since_s: Float64[np.ndarray, " person"]
) -> Float64[np.ndarray, " person"]:
    """Return for how long each detection supports somebody, by the quality of its key points [s].

    `since_s` is the time since its camera's last image.
    """
    seen = np.isfinite(found.xy_px[..., 0])
    quality = np.where(seen, 1.0 / found.sigma_scale, 0.0).sum(axis=1) / seen.sum(axis=1)
    return np.asarray(np.minimum(since_s, LONGEST_STEP_S) * quality**2)


def first_ranges(
    found: Detections, level: tuple[float, float], model: Model
) -> tuple[Ranges, Bool[np.ndarray, " person"], Float64[np.ndarray, "person joint 3"]]:
    """Return how far away people are of whom one detection each is known.

    Parameters
    ----------
    found, level, model
        The detections, height of the ground under somebody new, and its variance [m, m^2], and
        constants of the run.

    Returns
    -------
    The distances, whether all that was told of each was believed, and the joints at 1 m.
    """
    n, n_joint = found.sigma_scale.shape
    ranges = Ranges(
        np.empty(n, np.int64), np.empty((n, 4)), np.empty((n, 4, 4)), np.empty(n, np.bool_)
    )
    agrees, at_one_m = np.empty(n, np.bool_), np.empty((n, n_joint, 3))
    kernels.first_distances(
        model.cameras, model.ruler, found.cam, (found.xy_px, found.sigma_scale), level, ranges,
        agrees, at_one_m,
    )  # fmt: skip
    return ranges, agrees, at_one_m
