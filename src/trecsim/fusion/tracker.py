"""The one object with state: frame sets in, people in 3D out."""

import math

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.errors import InputError
from trecsim.fusion import birth, kernels, lifecycle, memory
from trecsim.fusion.association import Association, associate
from trecsim.fusion.clocks import JUMP_S, Clocks
from trecsim.fusion.images import Detections, Images, prepare
from trecsim.fusion.kernels.presence import SUPPORT_S
from trecsim.fusion.memory import Lost
from trecsim.fusion.model import build
from trecsim.fusion.population import Population
from trecsim.fusion.settings import FusionSettings
from trecsim.fusion.snapshots import SAME_S, snapshot_of
from trecsim.fusion.spline import ORDER, KnotGrid
from trecsim.geometry import Rig
from trecsim.skeleton import COCO17, Skeleton
from trecsim.types import FrameSet, Poses2D, Snapshot

# Leftover detections of different cameras this close in time may begin a person together [s].
_PAIR_S = 0.1
_CLOSE_S = 0.25
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
        self._leftover = Detections.nothing(len(skeleton.joints))
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
        images = prepare(views, self._model)
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
            if view.xy_px.shape[1:] != (n_joint, 2) or not math.isfinite(view.t_s):
                raise InputError(
                    f"camera {view.camera!r}: expected poses of {n_joint} joints at a finite time, "
                    f"found {view.xy_px.shape[1]} joints at t_s = {view.t_s}"
                )
        cam = np.array([self._camera(view) for view in views], np.int64)
        t_s = np.array([view.t_s for view in views], np.float64)
        use, anew = self._clocks.judge(cam, t_s)
        if anew:
            self._restart()
        if self._grid is not None:
            use &= t_s >= self._grid.start_s
        return [view for view, good in zip(views, use, strict=True) if good]

    def _camera(self, view: Poses2D) -> int:
        cam = self._model.cam_of.get(view.camera)
        return self._model.rig.index(view.camera) if cam is None else cam

    def _restart(self) -> None:
        """Forget everybody, as nobody can be followed over a jump in time; identities go on."""
        self._grid = None
        self._departed = []
        self._people = self._nobody()
        self._leftover = Detections.nothing(len(self._model.skeleton.joints))
        self._lost = []
        self._close_since = {}

    def _advance(self, t_s: float) -> None:
        """Move the knot grid on to `t_s`; every joint gets new control points as needed."""
        s = self._model.settings
        if self._grid is None:
            self._grid = KnotGrid(t_s - (self._live - ORDER) * s.knot_s, s.knot_s, self._live)
        steps = self._grid.steps_to(t_s)
        if not steps:
            return
        self._grid = self._grid.moved_to(t_s)
        people = self._people
        seen = lifecycle.support(people, t_s - s.knot_s)
        for _ in range(steps):
            kernels.extend_all(
                people.R, people.z, people.c, seen, self._model.torso, self._model.stiffness,
                math.exp(-s.knot_s / s.velocity_memory_s), math.exp(-s.knot_s / s.drag_memory_s),
            )  # fmt: skip

    def _update(self, images: Images, elapsed_s: float) -> Association:
        """Associate and fit everybody who is already there."""
        people = self._people
        xyz, prior = self._predicted(people, images)
        association = associate(self._model, images, xyz, prior)
        worth = min(max(elapsed_s / self._model.settings.error_memory_s, 0.05), 1.0)
        inlier, found, found_m2 = self._fit(people, images, association, xyz, prior, worth)
        lifecycle.note_support(people, images, association, inlier, self._t_s, elapsed_s)
        self._constrain(found, found_m2, elapsed_s, worth)
        lifecycle.mend_mirrored(people, self._model)
        self._clocks.note(images.cam, images.t_s)
        return association

    def _predicted(
        self, people: Population, images: Images
    ) -> tuple[Float64[np.ndarray, "view track joint 3"], Float64[np.ndarray, "track joint 3 3"]]:
        """Return where everybody should be in each image, and how sure that is by now."""
        n_track, n_joint = people.z.shape[:2]
        xyz = np.empty((len(images), n_track, n_joint, 3))
        kernels.evaluate_all(people.c, self._places(images), xyz)
        prior = np.empty((n_track, n_joint, 3, 3))
        kernels.covariance_all(people.R, self._knots.place(self._t_s), prior)
        return xyz, prior

    def _places(self, images: Images) -> Float64[np.ndarray, " view"]:
        grid = self._knots
        return np.asarray((images.t_s - grid.origin_s) / grid.knot_s - grid.first)

    def _fit(
        self,
        people: Population,
        images: Images,
        association: Association,
        xyz_m: Float64[np.ndarray, "view track joint 3"],
        prior_m2: Float64[np.ndarray, "track joint 3 3"],
        body_worth: float,
    ) -> tuple[
        Float64[np.ndarray, "track view joint"],
        Float64[np.ndarray, "track joint 3"],
        Float64[np.ndarray, "track joint 3 3"],
    ]:
        """Fit `people` to their detections.

        Returns the joints' responsibilities, and where the key points alone put the joints.
        """
        m = self._model
        inlier = np.empty((len(people), len(images), len(m.skeleton.joints)))
        found, found_m2 = np.empty(people.x_m.shape), np.empty(people.cov_m2.shape)
        worth = np.clip(
            self._clocks.since_s(images.cam, images.t_s) / m.settings.error_memory_s, 0.05, 1.0
        )
        kernels.fit_all(
            people.R, people.z, people.c, xyz_m, prior_m2, images.cam, m.P, m.focal_px,
            self._places(images), images.xy_px, images.factor, association.match, association.flip,
            association.responsibility * worth, m.noise, self._knots.place(self._t_s),
            lifecycle.support(people, self._t_s), m.limbs, people.limb_m, people.limb_m2,
            body_worth, inlier, found, found_m2, people.x_m, people.cov_m2,
        )  # fmt: skip
        return inlier, found, found_m2

    def _constrain(
        self,
        found_m: Float64[np.ndarray, "track joint 3"],
        found_m2: Float64[np.ndarray, "track joint 3 3"],
        elapsed_s: float,
        worth: float,
    ) -> None:
        """Learn limb lengths, and hold by them what too few cameras see."""
        people, m = self._people, self._model
        kernels.constrain_all(
            people.R, people.z, people.c, found_m, found_m2, people.x_m, people.cov_m2,
            lifecycle.support(people, self._t_s), m.limbs, people.limb_m, people.limb_m2,
            self._knots.place(self._t_s), elapsed_s, worth,
        )  # fmt: skip

    def _begin(self, images: Images, association: Association) -> Bool[np.ndarray, " track"]:
        """Let people begin where detections of two or more cameras meet; mark who is replaced.

        Whom one camera alone sees now may have drifted, or may never have been right:
        those detections are looked at again, together with what the other cameras cannot explain.
        """
        replaced = np.zeros(len(self._people), bool)
        owner = self._owners(images, association)
        old = self._leftover
        if len(old):
            old = old.take(~np.isin(old.cam, images.cam) & (self._t_s - old.t_s <= _PAIR_S))
        open_ = owner != _TAKEN
        if not len(old) and not open_.any():
            self._leftover = old
            return replaced
        pool = old.joined(images.detections(open_))
        owner = np.concatenate([np.full(len(old), _FREE), owner[open_]])
        free = owner == _FREE
        for candidate in birth.candidates(self._model, pool):
            owners = np.unique(owner[candidate.member])
            owners = owners[owners >= 0]
            if replaced[owners].any():  # each is replaced once
                continue
            free[candidate.member] = False
            torso = birth.completed(candidate.xyz_m, self._model)[self._model.torso]
            eyes = np.isin(images.cam, pool.cam[candidate.member])
            if not len(owners) and lifecycle.is_known(
                self._people, torso, eyes, association, self._model
            ):
                continue
            self._add(candidate, pool, owners)
            replaced[owners] = True
        self._leftover = pool.take(free)
        return replaced

    def _owners(self, images: Images, association: Association) -> Int64[np.ndarray, " person"]:
        """Return for each detection its lonely track, or whether it is free or taken."""
        owner = np.full(len(images.xy_px), _FREE, np.int64)
        track, view = np.nonzero(association.match >= 0)
        lonely = self._t_s - self._people.two_s > SUPPORT_S
        owner[association.match[track, view]] = np.where(lonely[track], track, _TAKEN)
        return owner

    def _add(
        self,
        candidate: birth.Candidate,
        pool: Detections,
        owners: Int64[np.ndarray, " owner"],
    ) -> None:
        """Add somebody new, somebody who is back, or a better place for the tracks `owners`."""
        identity, known = self._identify(candidate, owners)
        person = birth.newborn(candidate, identity, self._t_s, self._live, self._model)
        person.confirmed[:] = known or candidate.sure
        images = pool.take(candidate.member).as_images()
        match = np.arange(len(images), dtype=np.int64)[None]
        association = Association(match, candidate.flip[None], np.ones(match.shape))
        xyz, prior = self._predicted(person, images)
        # Its images have just been noted, so they weigh little here: the candidate's place is
        # theirs already, and the next frame set counts in full.
        inlier, _, _ = self._fit(person, images, association, xyz, prior, 1.0)
        lifecycle.note_support(person, images, association, inlier, self._t_s, 0.0)
        self._people = self._people.joined(person)

    def _identify(
        self, candidate: birth.Candidate, owners: Int64[np.ndarray, " owner"]
    ) -> tuple[int, bool]:
        """Return the candidate's identity, and whether it has been reported before."""
        if len(owners):
            oldest = owners[np.argmin(self._people.id[owners])]
            return int(self._people.id[oldest]), bool(self._people.confirmed[oldest])
        torso = birth.completed(candidate.xyz_m, self._model)[self._model.torso].mean(axis=0)
        back = memory.recall(self._lost, torso, self._t_s, self._model.settings.recall_s)
        if back is not None:
            self._lost.remove(back)
            return back.id, True
        self._next_id += 1
        return self._next_id - 1, False

    def _end(self, association: Association, replaced: Bool[np.ndarray, " old_track"]) -> None:
        """Drop duplicates and those whom nobody sees any more."""
        people, n_old = self._people, len(replaced)
        pairs = lifecycle.close_pairs(people, self._model, association)
        close = {(int(people.id[i]), int(people.id[k])): k for i, k in pairs}
        self._close_since = {p: self._close_since.get(p, self._t_s) for p in close}
        expected = lifecycle.expected_cameras(
            people, self._model, self._clocks.looking(), self._t_s
        )
        stays = lifecycle.survivors(people, self._model, expected, self._t_s)
        if not close and stays.all() and not replaced.any():
            return
        alive = np.ones(len(people), bool)
        alive[:n_old] = ~replaced
        for pair, younger in close.items():
            if self._t_s - self._close_since[pair] >= _CLOSE_S:
                alive[younger] = False
        left = ~stays & alive
        gone = memory.remembered(
            people, left & people.confirmed, self._knots, self._model, self._t_s
        )
        recall_s = self._model.settings.recall_s
        self._lost = memory.still_near(self._lost, self._t_s, recall_s) + gone
        left[:n_old] |= replaced
        self._depart(people.keep(left & people.confirmed))
        self._people = people.keep(alive & stays)

    def _depart(self, people: Population) -> None:
        """Keep people who are gone until the lag has reached their end."""
        if self._lag_s > 0.0 and len(people) and self._grid is not None:
            self._departed.append((self._t_s, self._grid, people))

    def _snapshot(self, now_s: float) -> Snapshot:
        """Return everybody who was there at `now_s` minus the lag, gone since or not."""
        t_s = now_s - self._lag_s
        self._departed = [one for one in self._departed if one[0] > t_s + SAME_S]
        there = [(one[1], one[2]) for one in self._departed]
        if self._grid is not None:
            there.append((self._grid, self._people.keep(self._people.confirmed)))
        return snapshot_of(there, t_s, self._t_s, len(self._model.skeleton.joints))
