"""The one object with state: frame sets in, people in 3D out."""

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.errors import InputError
from trecsim.fusion import birth, kernels, lifecycle
from trecsim.fusion.association import Association, associate
from trecsim.fusion.clocks import JUMP_S, Clocks
from trecsim.fusion.images import Images, prepare
from trecsim.fusion.lifecycle import Lost
from trecsim.fusion.model import build
from trecsim.fusion.population import Population
from trecsim.fusion.settings import FusionSettings
from trecsim.fusion.spline import ORDER, KnotGrid
from trecsim.geometry import Rig
from trecsim.skeleton import COCO17, Skeleton
from trecsim.types import FrameSet, Poses2D, Snapshot

# Leftover detections of different cameras this close in time may begin a person together [s].
_PAIR_S = 0.1
_CLOSE_S = 0.25
# Whom only one camera has seen for so long is looked at anew [s].
_LONELY_S = 0.4
_FREE, _TAKEN = -1, -2


class Tracker:
    """Follow any number of people with any number of cameras.

    Parameters
    ----------
    rig
        The cameras.
    settings
        See `FusionSettings`.
    skeleton
        The joints that the 2D poses have.
    lag_s
        How far behind the newest image `step` reports [s]; what comes later smooths it.

    Examples
    --------
    ::

        tracker = Tracker(rig)
        for frame_set in frame_sets(read_poses(path)):
            snapshot = tracker.step(frame_set)

    `trecsim.follow` does the same, and takes the rig's time offsets into account.
    """

    def __init__(
        self,
        rig: Rig,
        settings: FusionSettings | None = None,
        *,
        skeleton: Skeleton = COCO17,
        lag_s: float = 0.0,
    ) -> None:
        self._model = build(rig, skeleton, settings or FusionSettings())
        s = self._model.settings
        self._lag_s = lag_s
        self._live = ORDER + int(np.ceil(max(s.window_s, lag_s + s.knot_s) / s.knot_s))
        self._grid: KnotGrid | None = None
        self._people = self._nobody()
        self._clocks = Clocks(len(rig))
        self._leftover = Images.nothing(len(skeleton.joints))
        self._lost: list[Lost] = []
        self._departed: list[tuple[float, KnotGrid, Population]] = []
        self._close_since: dict[tuple[int, int], float] = {}
        self._next_id = 0

    def step(self, frame_set: FrameSet) -> Snapshot:
        """Take in one frame set and return where everybody is, at its time minus the lag."""
        before_s = self._clocks.now_s
        views = self._usable(frame_set)
        if not views:
            return self._snapshot(self._clocks.now_s if self._grid else frame_set.t_s)
        elapsed_s = max(0.0, self._t_s - before_s) if np.isfinite(before_s) else 0.0
        self._advance(self._t_s)
        n_joint = len(self._model.skeleton.joints)
        images = prepare(views, self._model.rig, n_joint, self._model.settings)
        association = self._update(images, min(elapsed_s, JUMP_S))
        replaced = self._begin(images, association)
        lifecycle.confirm(self._people, self._model, self._t_s)
        self._end(association, replaced)
        return self._snapshot(self._t_s)

    @property
    def _t_s(self) -> float:
        """Time of the newest image used [s]."""
        return self._clocks.now_s

    @property
    def _knots(self) -> KnotGrid:
        assert self._grid is not None, "the first frame set sets the grid"
        return self._grid

    def _nobody(self) -> Population:
        m = self._model
        return Population.nobody(len(m.skeleton.joints), self._live, len(m.rig), len(m.body.joints))

    def _usable(self, frame_set: FrameSet) -> list[Poses2D]:
        """Return the views that bring something new, are not too late and whose time is right."""
        views = frame_set.views
        n_joint = len(self._model.skeleton.joints)
        for view in views:
            if view.xy_px.shape[1:] != (n_joint, 2) or not np.isfinite(view.t_s):
                raise InputError(
                    f"camera {view.camera!r}: expected poses of {n_joint} joints at a finite time, "
                    f"found {view.xy_px.shape[1]} joints at t_s = {view.t_s}"
                )
        cam = np.array([self._model.rig.index(view.camera) for view in views], np.int64)
        t_s = np.array([view.t_s for view in views], np.float64)
        use, anew = self._clocks.judge(cam, t_s)
        if anew:
            self._restart()
        if self._grid is not None:
            use &= t_s >= self._grid.start_s
        return [view for view, good in zip(views, use, strict=True) if good]

    def _restart(self) -> None:
        """Forget everybody, as nobody can be followed over a jump in time; identities go on."""
        self._grid = None
        self._departed = []
        self._people = self._nobody()
        self._leftover = Images.nothing(len(self._model.skeleton.joints))
        self._lost = []
        self._close_since = {}

    def _advance(self, t_s: float) -> None:
        """Move the knot grid on to `t_s`; every joint gets new control points as needed."""
        s = self._model.settings
        if self._grid is None:
            self._grid = KnotGrid(t_s - (self._live - ORDER) * s.knot_s, s.knot_s, self._live)
        for _ in range(self._grid.steps_to(t_s)):
            self._extend(t_s)
        self._grid = self._grid.moved_to(t_s)

    def _extend(self, t_s: float) -> None:
        """Append one control point to every joint, carried by its own and the body's velocity."""
        people, s = self._people, self._model.settings
        if not len(people):
            return
        c = self._solve(people).reshape(len(people), -1, self._live, 3)
        own = c[:, :, -1] - c[:, :, -2]
        supported = lifecycle.support(people, t_s - s.knot_s) > 0
        torso = np.zeros(supported.shape)
        torso[:, self._model.torso] = np.where(supported[:, self._model.torso], 1.0, 0.05)
        drift = (own * torso[..., None]).sum(axis=1) / torso.sum(axis=1)[:, None]
        memory_s = np.where(supported, s.velocity_memory_s, s.drag_memory_s)
        kernels.extend_all(
            people.R, people.z, self._model.stiffness, np.exp(-s.knot_s / memory_s), drift
        )

    def _update(self, images: Images, elapsed_s: float) -> Association:
        """Associate and fit everybody who is already there."""
        xyz = self._at_images(self._people, images)
        prior = self._covariance_of(self._people, self._t_s)
        association = associate(self._model, images, xyz, prior)
        inlier = self._fit(self._people, images, association, xyz, prior)
        lifecycle.note_support(self._people, images, association, inlier, self._t_s, elapsed_s)
        lifecycle.mend_mirrored(self._people, association, self._model, elapsed_s)
        self._constrain(elapsed_s)
        self._clocks.note(images.cam, images.t_s)
        return association

    def _fit(
        self,
        people: Population,
        images: Images,
        association: Association,
        xyz_m: Float64[np.ndarray, "view track joint 3"],
        prior_m2: Float64[np.ndarray, "track joint 3 3"],
    ) -> Float64[np.ndarray, "track view joint"]:
        """Fit `people` to their detections and return the joints' responsibilities."""
        m, s = self._model, self._model.settings
        since = self._clocks.since_s(images.cam, images.t_s)
        worth = association.responsibility * np.clip(since / s.error_memory_s, 0.05, 1.0)
        inlier = np.zeros((len(people), len(images), len(m.skeleton.joints)))
        span, weights = images.placed(self._knots)
        kernels.fit_all(
            people.R, people.z, xyz_m, prior_m2, images.cam, m.P, m.focal_px, span, weights,
            images.xy_px, images.score, association.match, association.flip, worth, m.noise, inlier,
        )  # fmt: skip
        return inlier

    def _constrain(self, elapsed_s: float) -> None:
        """Learn limb lengths, and hold by them what too few cameras see."""
        people, m = self._people, self._model
        if not len(people):
            return
        span, weights = self._knots.locate(self._t_s)
        kernels.constrain_all(
            people.R,
            people.z,
            self._evaluate(people, self._solve(people), self._t_s),
            self._covariance_of(self._people, self._t_s),
            lifecycle.support(people, self._t_s),
            m.limbs,
            people.limb_m,
            people.limb_m2,
            span,
            weights,
            elapsed_s,
            float(np.clip(elapsed_s / m.settings.error_memory_s, 0.05, 1.0)),
        )

    def _begin(self, images: Images, association: Association) -> Bool[np.ndarray, " track"]:
        """Let people begin where detections of two or more cameras meet; mark who is replaced.

        Whom one camera alone has seen for a while may have drifted, or may never have been right:
        those detections are looked at again, together with what the other cameras cannot explain.
        """
        replaced = np.zeros(len(self._people), bool)
        owner = self._owners(images, association)
        old = self._leftover
        old = old.images(~np.isin(old.cam, images.cam) & (self._t_s - old.t_s <= _PAIR_S))
        open_ = np.flatnonzero(owner != _TAKEN)
        fresh = images.detections(open_)
        pool = old.joined(fresh)
        owner = np.concatenate([np.full(len(old.xy_px), _FREE), owner[open_]])
        used: list[int] = []
        for candidate in birth.candidates(self._model, pool):
            members = list(candidate.member.values())
            owners = np.unique(owner[members])
            owners = owners[owners >= 0]
            owners = owners[~replaced[owners]]  # each is replaced once
            self._add(candidate, pool, owners)
            replaced[owners] = True
            used.extend(members)
        free = np.setdiff1d(np.flatnonzero(owner == _FREE), used)
        self._leftover = pool.detections(free)
        return replaced

    def _owners(self, images: Images, association: Association) -> Int64[np.ndarray, " person"]:
        """Return for each detection its lonely track, or whether it is free or taken."""
        owner = np.full(len(images.xy_px), _FREE, np.int64)
        lonely = self._t_s - self._people.two_s > _LONELY_S
        for k, matches in enumerate(association.match):
            owner[matches[matches >= 0]] = k if lonely[k] else _TAKEN
        return owner

    def _add(
        self,
        candidate: birth.Candidate,
        pool: Images,
        owners: Int64[np.ndarray, " owner"],
    ) -> None:
        """Add somebody new, somebody who is back, or a better place for the tracks `owners`."""
        identity, known = self._identify(candidate, owners)
        person = birth.newborn(candidate, identity, self._t_s, self._live, self._model)
        person.confirmed[:] = known
        match = np.full((1, len(pool)), -1, np.int64)
        flip = np.zeros((1, len(pool)), np.int64)
        for view, detection in candidate.member.items():
            match[0, view], flip[0, view] = detection, candidate.flip[view]
        association = Association(match, flip, np.ones(match.shape))
        xyz, prior = self._at_images(person, pool), self._covariance_of(person, self._t_s)
        inlier = self._fit(person, pool, association, xyz, prior)
        lifecycle.note_support(person, pool, association, inlier, self._t_s, 0.0)
        self._people = self._people.joined(person)

    def _identify(
        self, candidate: birth.Candidate, owners: Int64[np.ndarray, " owner"]
    ) -> tuple[int, bool]:
        """Return the candidate's identity, and whether it has been reported before."""
        if len(owners):
            oldest = owners[np.argmin(self._people.id[owners])]
            return int(self._people.id[oldest]), bool(self._people.confirmed[oldest])
        torso = birth.completed(candidate.xyz_m, self._model)[self._model.torso].mean(axis=0)
        back = lifecycle.recall(self._lost, torso, self._t_s, self._model.settings.recall_s)
        if back is not None:
            self._lost.remove(back)
            return back.id, True
        self._next_id += 1
        return self._next_id - 1, False

    def _end(self, association: Association, replaced: Bool[np.ndarray, " old_track"]) -> None:
        """Drop duplicates and those whom nobody sees any more."""
        people = self._people
        if not len(people):
            self._close_since = {}
            return
        xyz = self._evaluate(people, self._solve(people), self._t_s)
        alive = np.ones(len(people), bool)
        alive[: len(replaced)] = ~replaced
        known = len(association.match)
        pairs = lifecycle.close_pairs(people.keep(np.arange(len(people)) < known), self._model,
                                      association, xyz[:known])  # fmt: skip
        close = {(int(people.id[i]), int(people.id[k])): k for i, k in pairs}
        self._close_since = {p: self._close_since.get(p, self._t_s) for p in close}
        for pair, younger in close.items():
            if self._t_s - self._close_since[pair] >= _CLOSE_S:
                alive[younger] = False
        expected = lifecycle.expected_cameras(self._model, xyz, self._clocks.looking())
        gone = ~lifecycle.survivors(people, self._model, expected, self._t_s)
        self._remember(people, xyz, gone & alive & people.confirmed & (expected > 0))
        left = gone & alive
        left[: len(replaced)] |= replaced
        self._depart(people.keep(left & people.confirmed))
        self._people = people.keep(alive & ~gone)

    def _depart(self, people: Population) -> None:
        """Keep people who are gone until the lag has reached their end."""
        if self._lag_s > 0.0 and len(people) and self._grid is not None:
            self._departed.append((self._t_s, self._grid, people))

    def _remember(
        self,
        people: Population,
        xyz_m: Float64[np.ndarray, "track joint 3"],
        who: Bool[np.ndarray, " track"],
    ) -> None:
        """Keep in mind people who were dropped in view, as they may come back."""
        recall_s = self._model.settings.recall_s
        self._lost = [one for one in self._lost if self._t_s - one.t_s <= recall_s]
        seen_s = people.camera_s.max(axis=1, initial=-np.inf)
        for k in np.flatnonzero(who):
            then = max(seen_s[k], self._t_s - self._model.settings.window_s + 0.1)
            one = people.keep(np.arange(len(people)) == k)
            c = self._solve(one)
            at = [
                self._evaluate(one, c, t)[0, self._model.torso].mean(axis=0)
                for t in (then - 0.1, then)
            ]
            self._lost.append(Lost(int(people.id[k]), then, at[1], (at[1] - at[0]) / 0.1))

    def _snapshot(self, now_s: float) -> Snapshot:
        """Return everybody who was there at `now_s` minus the lag, gone since or not."""
        t_s = now_s - self._lag_s
        self._departed = [one for one in self._departed if one[0] > t_s]
        there = [(one[1], one[2]) for one in self._departed]
        if self._grid is not None:
            there.append((self._grid, self._people.keep(self._people.confirmed)))
        parts = []
        for grid, people in there:
            known = people.keep(people.born_s <= t_s + 1e-9)
            if len(known):
                parts.append((known, grid))
        if not parts:
            return nobody_at(t_s, len(self._model.skeleton.joints))
        return Snapshot(
            t_s=t_s,
            id=np.concatenate([people.id for people, _ in parts]),
            xyz_m=np.concatenate(
                [self._evaluate(people, self._solve(people), t_s, grid) for people, grid in parts]
            ),
            cov_m2=np.concatenate(
                [self._covariance_of(people, t_s, grid) for people, grid in parts]
            ),
            support=np.concatenate([lifecycle.support(people, t_s) for people, _ in parts]),
        )

    def _solve(self, people: Population) -> Float64[np.ndarray, "track joint n"]:
        c = np.empty(people.z.shape)
        kernels.solve_all(people.R, people.z, c)
        return c

    def _evaluate(
        self,
        people: Population,
        c: Float64[np.ndarray, "track joint n"],
        t_s: float,
        grid: KnotGrid | None = None,
    ) -> Float64[np.ndarray, "track joint 3"]:
        span, weights = (grid or self._knots).locate(t_s)
        xyz = np.empty((len(people), c.shape[1], 3))
        kernels.evaluate_all(c, span, weights, xyz)
        return xyz

    def _at_images(
        self, people: Population, images: Images
    ) -> Float64[np.ndarray, "view track joint 3"]:
        c = self._solve(people)
        xyz = np.empty((len(images), len(people), c.shape[1], 3))
        for v, (span, weights) in enumerate(zip(*images.placed(self._knots), strict=True)):
            kernels.evaluate_all(c, span, weights, xyz[v])
        return xyz

    def _covariance_of(
        self, people: Population, t_s: float, grid: KnotGrid | None = None
    ) -> Float64[np.ndarray, "track joint 3 3"]:
        span, weights = (grid or self._knots).locate(t_s)
        cov = np.empty((len(people), people.R.shape[1], 3, 3))
        kernels.covariance_all(people.R, span, weights, cov)
        return cov


def nobody_at(t_s: float, n_joint: int) -> Snapshot:
    """Return a moment without anybody."""
    return Snapshot(
        t_s,
        np.empty(0, np.int64),
        np.empty((0, n_joint, 3)),
        np.empty((0, n_joint, 3, 3)),
        np.empty((0, n_joint), np.int64),
    )
