"""What the tracker says of the actors of the sample recording, laid beside their 2D labels."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from harness.actors_2d import LEAST_SCORE
from harness.body_parts import LIMB_JOINTS, LIMBS
from harness.demo_video import Recorded, frame_of

if TYPE_CHECKING:
    from trecsim.values import Snapshot

LAST_FRAME = 87  # where a lag of 0.2 s still has an answer
NEAR_PX = 150.0  # of an actor's key points, for a track to be that actor's

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Actor:
    """What is said of one actor; NaN where nothing is.

    Attributes
    ----------
    frames
        Of the snapshots, (moment,).
    xyz_m, cov_m2, support
        Joints, covariances and support of the track that is nearest, (moment, limb joint, ...).
    identity
        Of the track, -1 where there is none, (moment,).
    """

    frames: npt.NDArray[np.int64]
    xyz_m: Array
    cov_m2: Array
    support: npt.NDArray[np.int64]
    identity: npt.NDArray[np.int64]

    @property
    def found(self) -> float:
        """Share of the moments with a track."""
        return float((self.identity >= 0).mean())

    @property
    def switches(self) -> int:
        """How often the track bears another identity than the last one."""
        known = self.identity[self.identity >= 0]
        return int((np.diff(known) != 0).sum())

    @property
    def limbs_m(self) -> Array:
        """Lengths of the limbs, (moment, limb)."""
        index = {joint: n for n, joint in enumerate(LIMB_JOINTS)}
        ends = np.array([(index[a], index[b]) for a, b in LIMBS])
        out: Array = np.linalg.norm(self.xyz_m[:, ends[:, 0]] - self.xyz_m[:, ends[:, 1]], axis=-1)
        return out


def laid_beside(
    snapshots: Iterable["Snapshot"], scene: Recorded, first: int = 0, last: int = LAST_FRAME
) -> tuple[dict[str, Actor], int]:
    """Return what is said of each actor, and the number of person-moments that are nobody's.

    A track is the actor's whose labels in all cameras, used or not, are nearest to it.

    Parameters
    ----------
    snapshots
        Of a tracker.
    scene
        The recording.
    first, last
        The frames that count.
    """
    kept = [s for s in snapshots if first <= frame_of(s.t_s) <= last and s.t_s > -1e-6]
    shown = [who for who in ("man", "woman", "bystander") if who in scene.labels["cam01"]]
    n, nobody = len(kept), 0
    frames = np.array([frame_of(s.t_s) for s in kept])
    joints = len(LIMB_JOINTS)
    found = {
        who: Actor(
            frames, np.full((n, joints, 3), np.nan), np.full((n, joints, 3, 3), np.nan),
            np.full((n, joints), -1), np.full(n, -1),
        )
        for who in shown
    }  # fmt: skip
    for moment, snapshot in enumerate(kept):
        whose = _whose(snapshot, scene, shown)
        nobody += sum(who is None for who in whose)
        for row, who in enumerate(whose):
            if who is not None:
                one = found[who]
                one.xyz_m[moment] = snapshot.xyz_m[row, LIMB_JOINTS]
                one.cov_m2[moment] = snapshot.cov_m2[row, LIMB_JOINTS]
                one.support[moment] = snapshot.support[row, LIMB_JOINTS]
                one.identity[moment] = snapshot.id[row]
    return {who: found[who] for who in scene.actors}, nobody


def _whose(snapshot: "Snapshot", scene: Recorded, shown: Sequence[str]) -> list[str | None]:
    """Return for each track of a snapshot whose it is."""
    from scipy.optimize import linear_sum_assignment

    people, frame = len(snapshot.id), frame_of(snapshot.t_s)
    out: list[str | None] = [None] * people
    off_px = np.full((people, len(shown)), np.inf)
    for row in range(people):
        for column, who in enumerate(shown):
            apart = [
                reprojected_px(scene, name, who, frame, snapshot.xyz_m[row, LIMB_JOINTS])
                for name in scene.rig.names
            ]
            known = np.concatenate(apart)
            known = known[np.isfinite(known)]
            if len(known):
                off_px[row, column] = np.median(known)
    rows, columns = linear_sum_assignment(np.minimum(off_px, 1e4))
    for row, column in zip(rows, columns, strict=True):
        if off_px[row, column] <= NEAR_PX:
            out[row] = shown[column]
    return out


def label(scene: Recorded, camera: str, who: str, frame: int) -> Array:
    """Return an actor's limb joints in an image [px], NaN where not shown well, (joint, 2)."""
    labels: Mapping[str, Array] = scene.labels[camera]
    if who not in labels:
        return np.full((len(LIMB_JOINTS), 2), np.nan)
    shown = labels[who][frame, LIMB_JOINTS]
    out: Array = np.where((shown[:, 2] >= LEAST_SCORE)[:, None], shown[:, :2], np.nan)
    return out


def reprojected_px(scene: Recorded, camera: str, who: str, frame: int, xyz_m: Array) -> Array:
    """Return how far limb joints are from an actor's labels in a camera [px], (joint,)."""
    off: Array = np.linalg.norm(
        scene.rig[camera].project(xyz_m) - label(scene, camera, who, frame), axis=-1
    )
    return off
