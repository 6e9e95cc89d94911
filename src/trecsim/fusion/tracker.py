"""The tracker, the only object with state: frame sets in, people in 3D out."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.errors import InputError
from trecsim.fusion import birth, evidence, fitting, kernels, lifecycle
from trecsim.fusion.arguments import check_arguments
from trecsim.fusion.camera_errors import CameraErrors
from trecsim.fusion.duplicates import Duplicates, is_duplicate
from trecsim.fusion.fitting import Step, Update
from trecsim.fusion.ground_prior import KnownGround
from trecsim.fusion.images import Detections, Images, cameras, prepare
from trecsim.fusion.initialisation import Birth, completed, first_states, own_detections
from trecsim.fusion.kernels import Cameras, Matches, Now
from trecsim.fusion.lifecycle import Looks
from trecsim.fusion.model import build
from trecsim.fusion.population import Population
from trecsim.fusion.reidentification import (
    Identities,
    LostTrack,
    lost_since,
    lost_tracks,
    nearest_unseen,
)
from trecsim.fusion.reports import Reports
from trecsim.fusion.settings import FusionSettings
from trecsim.fusion.single_views import NOBODY, Company, SingleViews
from trecsim.fusion.spline import ORDER, KnotGrid
from trecsim.fusion.tuning import CHECK_S, TORN_LOOK_BACK
from trecsim.geometry import Rig
from trecsim.skeleton import COCO17, Skeleton
from trecsim.sync.clocks import JUMP_S, Clocks
from trecsim.values import FrameSet, Poses2D, Snapshot


class Held(NamedTuple):
    """How much a tracker keeps in memory: small numbers, however long it runs.

    Attributes
    ----------
    tracks
        Tracks that two cameras began, provisional ones included.
    single_views
        Tracks of people whom one camera alone sees.
    unassigned
        Detections that wait for one of another camera to start a track with.
    dead
        Dead tracks whose people may still be re-identified.
    close_pairs
        Pairs of tracks that may be duplicates.
    ended
        Groups of dead tracks that the lag has not passed yet.
    """

    tracks: int
    single_views: int
    unassigned: int
    dead: int
    close_pairs: int
    ended: int


class Tracker:
    """Track any number of people with any number of cameras.

    Parameters
    ----------
    rig
        The cameras.
    settings
        See `FusionSettings`.
    skeleton
        The joints that the 2D poses have.
    lag_s
        How far behind the newest image `step` reports [s], up to 10; what comes later smooths it.
    first_id
        Identity of the first person; above all that a recording which is continued holds.
    provisional
        Whether `step` reports tracks that are not confirmed yet, too.

    Raises
    ------
    InputError, ConfigError
        One of these is something else than it should be; the message tells which.

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
        first_id: int = 0,
        provisional: bool = False,
    ) -> None:
        check_arguments(rig, settings, skeleton, lag_s)
        self._errors = CameraErrors(rig)
        self._model = build(rig, skeleton, settings or FusionSettings(), self._errors.known)
        s = self._model.settings
        self._provisional = provisional
        self._reports = Reports(lag_s, provisional)
        self._live = ORDER + int(np.ceil(max(s.window_s, lag_s + s.knot_s) / s.knot_s))
        self._clocks = Clocks(len(rig))
        self._times = lifecycle.look_back(self._clocks.usual_s())
        self._identities = Identities(s.reidentify_s, first_id)
        self._restart()

    def step(self, frame_set: FrameSet) -> Snapshot:
        """Take in one frame set and return where everybody is, at its time minus the lag.

        Parameters
        ----------
        frame_set
            Images of some cameras. A set without images lets time pass up to its own time: tracks
            that no camera supports end, also when all cameras are silent.
        """
        before_s = self._clocks.now_s
        views = self._usable(frame_set)
        if not views and (frame_set.views or self._grid is None):
            return self._snapshot(self._clocks.now_s if self._grid else frame_set.t_s)
        self._times = lifecycle.look_back(self._clocks.usual_s())
        elapsed_s = max(0.0, self._t_s - before_s) if math.isfinite(before_s) else 0.0
        images = prepare(views, self._model)
        step, update = self._update(images, min(elapsed_s, JUMP_S))
        claim = self._single.take(images, update, step)
        replaced, left = self._start_tracks(images, update, claim)
        self._follow_single_views(images, update.association, step, left)
        self._end_tracks(update.association, replaced)
        self._reports.note(self._t_s, (self._people, self._single.people), self._looks)
        return self._snapshot(self._t_s)

    def take_rig(self, rig: Rig) -> None:
        """Go on with the same cameras, calibrated anew; tracks and identities go on.

        What residuals told of the cameras belongs to the old rig, and is forgotten.

        Raises
        ------
        InputError
            When they are other cameras.
        """
        m = self._model
        check_arguments(rig, m.settings, m.skeleton, 0.0)
        if rig.names != m.rig.names:
            raise InputError(f"expected the cameras {m.rig.names}, found {rig.names}")
        self._errors = CameraErrors(rig)
        self._model = build(rig, m.skeleton, m.settings, self._errors.known)
        self._single.model = self._model
        self._unassigned = Detections.nothing(len(m.skeleton.joints))

    @property
    def held(self) -> Held:
        """How much the tracker keeps in memory."""
        return Held(
            len(self._people), len(self._single), len(self._unassigned),
            len(self._identities.dead), len(self._duplicates), len(self._reports),
        )  # fmt: skip

    @property
    def camera_errors(self) -> CameraErrors:
        """What residuals tell of the cameras: turns, and delays of their clocks."""
        return self._errors

    @property
    def cameras(self) -> Cameras:
        """The projections in use: the rig's, with those errors taken out."""
        return self._model.cameras

    @property
    def _t_s(self) -> float:
        """Time of the newest image used [s]."""
        return self._clocks.now_s

    @property
    def _knots(self) -> KnotGrid:
        assert self._grid is not None, "the first frame set sets the grid"
        return self._grid

    @property
    def _looks(self) -> Looks:
        return Looks(self._clocks.newest_s, self._times.look_back_s)

    def _restart(self) -> None:
        """Delete all tracks, as none can be followed over a jump in time; identities go on."""
        m = self._model
        n_joint = len(m.skeleton.joints)
        self._people = Population.empty(n_joint, self._live, len(m.rig), len(m.body.joints))
        self._single, self._ground = SingleViews(m, self._live), KnownGround()
        self._unassigned = Detections.nothing(n_joint)
        self._checked_s = -math.inf
        self._grid: KnotGrid | None = None
        self._identities.dead = []
        self._reports.forget()
        self._duplicates = Duplicates()
        # After a jump back, what is known of the cameras is forgotten from the new time on.
        self._errors.learned_s[:] = np.minimum(self._errors.learned_s, self._t_s)

    def _usable(self, frame_set: FrameSet) -> list[Poses2D]:
        """Return the views that are new, not too late and plausible in time."""
        views = frame_set.views
        t_s = [float(view.t_s) for view in views]
        if views:
            use, anew = self._clocks.judge(cameras(views, self._model), t_s)
        else:
            use, anew = [], self._clocks.move_on(frame_set.t_s)
        if anew:
            self._restart()
        start_s = -math.inf if self._grid is None else self._grid.start_s
        return [
            view for view, t, good in zip(views, t_s, use, strict=True) if good and t >= start_s
        ]

    def _update(self, images: Images, elapsed_s: float) -> tuple[Step, Update]:
        """Move the knot grid on, and take the images into the existing tracks."""
        people, m, t_s = self._people, self._model, self._t_s
        if self._grid is None:
            knot_s = m.settings.knot_s
            self._grid = KnotGrid(t_s - (self._live - ORDER) * knot_s, knot_s, self._live)
        cam, taken_s = images.cam.tolist(), images.t_s.tolist()
        late_s = self._errors.applied[:, 3].tolist()
        reach_s = max([t_s, *(t - late_s[c] for c, t in zip(cam, taken_s, strict=True))])
        appended = self._grid.steps_to(reach_s)
        self._grid = self._grid.moved_on(appended)
        since_s = self._clocks.since_s(cam, taken_s)
        check = t_s - self._checked_s >= CHECK_S
        if check:
            self._checked_s = t_s
        now = Now(t_s, elapsed_s, *self._grid.place)
        step = Step(now, since_s, self._times.look_back_s, self._clocks.apart(cam), appended)
        update = fitting.update(people, images, step, m, check=check)
        if check and self._errors.is_due(t_s):
            self._learn_cameras()
        if update.is_mirrored:
            evidence.unmirror(people, m)
        self._clocks.note(cam, taken_s)
        return step, update

    def _learn_cameras(self) -> None:
        """Take the cameras' errors out of the projections, as far as residuals tell them."""
        self._model = replace(self._model, cameras=self._errors.corrected())
        self._single.model = self._model

    def _start_tracks(
        self, images: Images, update: Update, claim: Int64[np.ndarray, " person"] | None
    ) -> tuple[set[int], Detections]:
        """Start tracks where unassigned detections of two or more cameras meet.

        Return the existing tracks that new ones replace, and the detections of this frame set that
        are left. A track that only one camera supports may have drifted, and the detections of one
        may be of two people: such detections count as unassigned, too.
        """
        replaced: set[int] = set()
        if not update.n_open and not len(self._unassigned):
            return replaced, self._unassigned
        n_old, pool, owner = self._open_detections(images, update, claim)
        free = owner == kernels.FREE
        candidates = list(birth.candidates(self._model, pool))
        births: list[Birth] = []
        named: set[int] = set()
        claimed: set[int] = set()  # tracks of one camera that new ones replace
        places_m = completed(candidates, self._model) if candidates else ()
        for candidate, xyz_m in zip(candidates, places_m, strict=True):
            owners = {o for o in owner[candidate.member].tolist() if o >= 0}
            unnamed = [o for o in sorted(owners) if int(self._people.id[o]) not in named]
            if owners and not unnamed:  # each identity is given only once
                continue
            free[candidate.member] = False
            own_views = np.isin(images.cam, pool.cam[candidate.member])
            if not owners and is_duplicate(
                self._people, xyz_m[self._model.torso], own_views, update.association, self._model
            ):
                continue
            velocity_mps = np.zeros(3)
            torso_m = xyz_m[self._model.torso].mean(axis=0)
            cam = pool.cam[candidate.member]
            lost = (
                None if owners else self._moved_on(torso_m, cam, images, update.association, named)
            )
            if lost is not None:
                owners = set(np.flatnonzero(self._people.id == lost.id).tolist())
                unnamed = sorted(owners)
                velocity_mps = lost.velocity_to(torso_m, self._t_s)
            claims = [
                k for k in self._single.rows(pool.claim[candidate.member]) if k not in claimed
            ]
            identity, known = self._identify(xyz_m, unnamed, claims)
            claimed.update(claims)
            births.append(Birth(candidate, xyz_m, identity, known, velocity_mps))
            named.add(identity)
            replaced |= owners
        self._drop_single_views(self._single.marked(claimed))
        self._add(births, pool)
        self._unassigned = pool.take(free)
        free[:n_old] = False
        return replaced, pool.take(free)

    def _open_detections(
        self, images: Images, update: Update, claim: Int64[np.ndarray, " person"] | None
    ) -> tuple[int, Detections, Int64[np.ndarray, " person"]]:
        """Return the detections that may start a track, and the track that each would replace.

        That is an index, or `FREE`. Unassigned detections of earlier frame sets come first; how
        many these are is returned before.
        """
        old = self._unassigned
        if len(old):
            old = old.still_open(images.cam, self._t_s - self._times.waiting_s)
        if not update.n_open:
            return len(old), old, np.full(len(old), kernels.FREE)
        open_ = update.owner != kernels.TAKEN
        owner = np.concatenate([np.full(len(old), kernels.FREE), update.owner[open_]])
        return len(old), old.joined(images.detections(open_, claim)), owner

    def _add(self, births: Sequence[Birth], pool: Detections) -> None:
        """Add new tracks, all in one fit to their detections in `pool`."""
        if not births:
            return
        people = first_states(births, self._t_s, self._knots, self._model)
        images, association = own_detections(births, pool)
        # Their images have just been noted, so they weigh little here: the first place is theirs
        # already, and the next frame set counts in full.
        since_s = self._clocks.since_s(images.cam.tolist(), images.t_s.tolist())
        now = Now(self._t_s, 0.0, *self._knots.place)
        step = Step(now, since_s, self._times.look_back_s, [False] * len(images))
        fitting.fit(people, images, association, step, self._model)
        self._people = self._people.joined(people)

    def _moved_on(
        self,
        torso_m: Float64[np.ndarray, "3"],
        cam: Int64[np.ndarray, " member"],
        images: Images,
        association: Matches,
        named: set[int],
    ) -> LostTrack | None:
        """Return the track whose person a new one at `torso_m`, seen by the cameras `cam`, is.

        Its person has moved further than the association allows, as in a fall. Tracks whose
        identities are `named` already do not count.
        """
        people, since_s = self._people, self._t_s - TORN_LOOK_BACK * self._times.look_back_s
        seen_s = lost_since(people.last_seen_s, cam, association.match, images.cam, since_s)
        seen_s[[identity in named for identity in people.id.tolist()]] = -np.inf
        if not np.isfinite(seen_s).any():
            return None
        tracks = lost_tracks(people, seen_s, self._knots, self._model, self._t_s)
        return nearest_unseen(tracks, torso_m, self._t_s)

    def _identify(
        self, xyz_m: Float64[np.ndarray, "joint 3"], owners: Sequence[int], claims: Sequence[int]
    ) -> tuple[int, bool]:
        """Return the identity of a new track, and whether it has been confirmed before.

        It is that of the oldest of the tracks `owners` that it replaces, or of a track that died
        lately where this one begins, or of the tracks of one camera `claims` that it replaces, or
        else a new one.
        """
        if owners:
            oldest = min(owners, key=lambda o: int(self._people.id[o]))
            return int(self._people.id[oldest]), bool(self._people.confirmed[oldest])
        torso_m = xyz_m[self._model.torso].mean(axis=0)
        back = self._identities.returning(torso_m, self._t_s)
        if back is not None:
            self._identities.dead.remove(back)
            return back.id, True
        mine = [identity for k in claims if (identity := int(self._single.people.id[k])) >= 0]
        return (min(mine), False) if mine else (self._identities.new(), False)

    def _end_tracks(self, association: Matches, replaced: set[int]) -> None:
        """Confirm tracks; delete those that are dead, duplicates or replaced."""
        people = self._people
        n_compared, looking = len(association.match), self._clocks.looking
        found = lifecycle.judge(people, self._model, n_compared, looking, self._t_s, self._looks)
        duplicates = self._duplicates.found(
            people, self._model, association, self._t_s, found.some_close
        )
        if not duplicates and not replaced and found.all_alive:
            return
        stays = found.is_alive
        alive = np.ones(len(people), bool)
        alive[[*replaced, *duplicates]] = False
        died = ~stays & alive
        seen_s = np.where(died & people.confirmed, people.last_seen_s.max(axis=1), -np.inf)
        gone = lost_tracks(people, seen_s, self._knots, self._model, self._t_s)
        self._identities.note_dead(gone, self._t_s)
        self._ground.note(people, died)
        died[list(replaced)] = True
        self._reports.keep(people, died & people.confirmed, self._knots, self._t_s)
        self._people = people.keep(alive & stays)

    def _follow_single_views(
        self, images: Images, association: Matches, step: Step, left: Detections
    ) -> None:
        """Begin, report and end tracks of people whom one camera alone sees."""
        if not len(left) and not len(self._single):
            return
        company = Company(self._people.xyz_m, association.match, step.look_back_s)
        fresh = left.take(left.claim == NOBODY)
        if len(fresh):
            level = self._ground.expected(self._people)
            self._single.begin(fresh, images, company, level, step, self._knots)
        self._drop_single_views(self._single.dead(company, self._t_s))
        for k in self._single.due(company, self._clocks.looking):
            self._single.people.id[k] = self._identities.new()

    def _drop_single_views(self, which: Bool[np.ndarray, " track"]) -> None:
        """Delete tracks of one camera; with a lag, those that were reported are kept for it."""
        if self._provisional:
            people = self._single.people
            self._reports.keep(people, which & (people.id != NOBODY), self._knots, self._t_s)
        self._single.drop(which)

    def _snapshot(self, now_s: float) -> Snapshot:
        """Return the tracks that were alive at `now_s` minus the lag, dead since or not."""
        alive = [] if self._grid is None else [(self._grid, self._people)]
        if self._grid is not None and self._provisional and len(self._single):
            alive.append((self._grid, self._single.people))
        return self._reports.snapshot(alive, now_s, self._t_s, self._looks, self._model)
