"""Keeps the rig of a live site right: a camera that was knocked is put right by the people."""

import logging
import shutil
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from threading import Lock

import numpy as np

from trecsim.errors import Error
from trecsim.geometry import Rig
from trecsim.geometry.rigid import rotation_vector
from trecsim.health import Health
from trecsim.service.kept_poses import KeptPoses
from trecsim.service.repair_job import Repaired, RepairJob
from trecsim.service.rig_repairs import RigRepairs
from trecsim.store.names import REPAIRING
from trecsim.values import Poses2D

logger = logging.getLogger(__name__)

SETTLED_S = 3.0  # that a camera is off is known since some seconds; then it stands still again
NEEDED_S = 15.0  # of people in the camera and in another one
AGAIN_S = 30.0  # after a try; after each one that failed, twice as long
LONGEST_AGAIN_S = 1800.0  # tries take a processor core: one that cannot succeed must stay rare
OTHERS_DEG = 0.3  # a repair that turns other cameras by more is refused


class RigKeeper:
    """Repairs the rig of a live site when a camera was knocked, and takes repairs back.

    It is a sink of 2D poses, and is told twice a second how well the site works. The repair runs in
    a process of its own. Only the poses of cameras that the tracking has named change, and only
    when the repair names the same ones. Clocks stay: the tracking estimates them by itself.

    Parameters
    ----------
    rig
        That of the site file.
    repairs
        Where repairs are kept. The one in force is taken over at the start, and taken back when its
        file is gone.
    automatic
        Whether cameras are repaired; without it nothing is done.
    revoke_by
        The command that takes a repair back.
    clock
        A steady clock [s].
    launch
        Begins a repair: is given the rig in force, 2D poses, and the folder to work in.
    """

    def __init__(
        self,
        rig: Rig,
        repairs: RigRepairs,
        *,
        automatic: bool,
        revoke_by: str,
        clock: Callable[[], float] = time.monotonic,
        launch: Callable[..., RepairJob] = RepairJob,
    ) -> None:
        self._site_rig, self._repairs, self._automatic = rig, repairs, automatic
        self._revoke_by, self._clock, self._launch = revoke_by, clock, launch
        self._poses = KeptPoses(rig)
        self._lock = Lock()
        self._rig = repairs.rig(rig) if automatic else rig
        self._offered = self._rig if self._rig is not rig else None
        self._job: RepairJob | None = None
        self._wanted: dict[str, float] = {}
        self._tried_s, self._again_s = -np.inf, AGAIN_S
        self._revoked: set[str] = set()
        if automatic:  # what a process that was killed has left
            for left in repairs.folder.glob(REPAIRING + "*"):
                shutil.rmtree(left, ignore_errors=True)
        if self._offered is not None:
            logger.warning("%s; take it back: %s", self._told(), revoke_by)

    @property
    def repaired_deg(self) -> dict[str, float]:
        """By how much cameras are turned from the rig of the site file [degrees]."""
        return turned_deg(self._site_rig, self._rig)

    def judged(self, health: Health) -> Health:
        """Return the health of a site with what was repaired of its rig."""
        repaired = self.repaired_deg
        if not repaired:
            return health
        cameras = {
            name: replace(camera, repaired_deg=repaired.get(name))
            for name, camera in health.cameras.items()
        }
        return replace(health, cameras=cameras)

    def write(self, poses: Poses2D, /) -> None:
        """Take one more image."""
        if self._automatic:
            self._poses.write(poses)

    def new_rig(self) -> Rig | None:
        """Return a rig that is to be used from now on, once; None where nothing has changed."""
        if self._offered is None:  # asked for with each image: no lock where nothing is
            return None
        with self._lock:
            rig, self._offered = self._offered, None
        return rig

    def __call__(self, health: Health) -> None:
        """Look whether a camera is to be repaired, or a repair was taken back."""
        if not self._automatic:
            return
        self._look_whether_revoked()
        if self._job is not None:
            result = self._job.result()
            if result is not None:
                self._job = None
                self._take(result)
        else:
            self._begin(health)

    def close(self) -> None:
        """End a repair that runs."""
        if self._job is not None:
            self._job.close()
            self._job = None

    def _begin(self, health: Health) -> None:
        off = {
            name: camera.moved_since_s
            for name, camera in health.cameras.items()
            if camera.moved_since_s is not None and name not in self._revoked
        }
        if not off or self._clock() - self._tried_s < self._again_s:
            return
        since_s = max(off.values()) + SETTLED_S
        if min(self._poses.seconds_of_people(name, since_s) for name in off) < NEEDED_S:
            return
        self._tried_s = self._clock()
        self._wanted = {name: health.cameras[name].moved_deg or 0.0 for name in off}
        logger.warning("%s: a repair from the people begins", _listed(self._wanted))
        try:
            self._job = self._launch(self._rig, self._poses.since(since_s), self._repairs.folder)
        except (Error, OSError) as error:
            self._refuse(str(error))

    def _take(self, result: Repaired) -> None:
        """Use what a repair found, or say why not."""
        why = self._refusal(result)
        if why is not None or result.rig is None:
            self._refuse(why or "there is no rig")
            return
        rig = Rig(
            tuple(
                replace(camera, T_cam_world=result.rig[camera.name].T_cam_world)
                if camera.name in self._wanted
                else camera
                for camera in self._rig
            )
        )
        try:
            self._repairs.put(rig, self._site_rig, turned_deg(self._site_rig, rig), result.reasons)
        except Error as error:
            self._refuse(str(error))
            return
        self._again_s = AGAIN_S
        self._use(rig)
        logger.warning("%s; take it back: %s", self._told(), self._revoke_by)

    def _refuse(self, why: str) -> None:
        """Say why nothing is repaired, and wait longer before the next try."""
        self._again_s = min(2.0 * self._again_s, LONGEST_AGAIN_S)
        logger.warning(
            "%s: not repaired: %s; tried again in %.0f s at the earliest",
            _listed(self._wanted), why, self._again_s,
        )  # fmt: skip
        self._repairs.note("refused", cameras=self._wanted, why=why)

    def _refusal(self, result: Repaired) -> str | None:
        if result.rig is None or result.verdict == "wrong":
            return result.reasons[0]
        unnamed = sorted(set(self._wanted) - set(result.off))
        if unnamed:
            return f"the repair does not find {', '.join(map(repr, unnamed))} off"
        others = {
            name: turn
            for name, turn in result.off.items()
            if name not in self._wanted and turn > OTHERS_DEG
        }
        if others:
            return f"it would turn other cameras, too: {_listed(others)}; calibrate anew"
        return None

    def _look_whether_revoked(self) -> None:
        if self._rig is self._site_rig or not self._repairs.is_revoked:
            return
        self.close()  # of a repair that runs, the poses are of the rig that was
        self._revoked |= set(self.repaired_deg)
        named = ", ".join(map(repr, sorted(self._revoked)))
        self._use(self._site_rig)
        logger.warning(
            "the repair of the rig was taken back: the rig of the site file is used again; %s is "
            "not repaired again before the next start",
            named,
        )

    def _use(self, rig: Rig) -> None:
        self._rig = rig
        with self._lock:
            self._offered = rig

    def _told(self) -> str:
        return (
            f"the rig is repaired: {_listed(self.repaired_deg)} from the rig of the site file; the "
            f"repaired one is in {self._repairs.folder}"
        )


def turned_deg(before: Rig, after: Rig) -> dict[str, float]:
    """Return by how much cameras are turned from one rig to another, those that are [degrees]."""
    turns = {}
    for camera in before:
        turn = after[camera.name].T_cam_world[:3, :3] @ camera.T_cam_world[:3, :3].T
        turns[camera.name] = round(float(np.degrees(np.linalg.norm(rotation_vector(turn)))), 3)
    return {name: turn for name, turn in turns.items() if turn > 0.0}


def _listed(turn_deg: Mapping[str, float]) -> str:
    return ", ".join(f"camera {name!r} by {turn:.2f} degrees" for name, turn in turn_deg.items())
