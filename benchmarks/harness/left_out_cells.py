"""Key points of cameras that were not used, beside what the tracker says; and noise and jitter."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from harness import regions
from harness.actor_tracks import LAST_FRAME, Actor, label
from harness.demo_video import Recorded
from trecsim.geometry.triangulation import triangulate

Array = npt.NDArray[np.float64]

# A position beside the cubic through two before and two after it; scaled, so that white noise of
# unit standard deviation gives 1.
_CUBIC = np.array([-1.0, 4.0, 0.0, 4.0, -1.0]) / 6.0
_SCALE = float(np.sqrt(1.0 + (_CUBIC**2).sum()))


@dataclass(frozen=True, slots=True, eq=False)
class LeftOut:
    """Each key point of left-out cameras beside the joint that is said to be there; NaN if none.

    Attributes
    ----------
    off_px
        Joint minus key point, (camera, frame, joint, 2).
    cov_px2
        The joint's covariance in that image, (camera, frame, joint, 2, 2).
    sure_m
        How far its 90 % region reaches, (camera, frame, joint).
    """

    off_px: Array
    cov_px2: Array
    sure_m: Array

    @property
    def px(self) -> Array:
        """Length of each difference, (camera, frame, joint)."""
        out: Array = np.linalg.norm(self.off_px, axis=-1)
        return out

    @property
    def known(self) -> regions.Flags:
        """Which there are, (camera, frame, joint)."""
        out: regions.Flags = np.isfinite(self.px)
        return out

    def errors(self, noise_px: float) -> regions.Errors:
        """Return them with what is stated of them, the noise of key points included."""
        noise_px2 = noise_px**2 * np.eye(2)
        return regions.Errors(self.off_px[self.known], self.cov_px2[self.known] + noise_px2)


def left_out(scene: Recorded, who: str, used: tuple[str, ...], one: Actor) -> LeftOut:
    """Return all key points of one actor in the cameras that were not used."""
    names = [name for name in scene.rig.names if name not in used]
    shape = (len(names), LAST_FRAME + 1, one.xyz_m.shape[1])
    off, cov = np.full((*shape, 2), np.nan), np.full((*shape, 2, 2), np.nan)
    sure = np.full(shape, np.nan)
    there = np.flatnonzero(one.identity >= 0)
    for number, name in enumerate(names):
        camera = scene.rig[name]
        for moment, frame in zip(there, one.frames[there], strict=True):
            pixels, by_world = camera.project_with_jacobian(one.xyz_m[moment])
            cov_m2 = one.cov_m2[moment]
            off[number, frame] = pixels - label(scene, name, who, int(frame))
            cov[number, frame] = by_world @ cov_m2 @ by_world.transpose(0, 2, 1)
            sure[number, frame] = regions.widest(cov_m2)
    return LeftOut(off, cov, sure)


def noise_px(scene: Recorded, who: str) -> float:
    """Return the noise of an actor's key points per axis: residuals of fits to four cameras [px].

    Each joint of each frame is triangulated from three or four cameras by itself. Some key points
    are false: the median of the squared residuals counts, over that of their distribution.
    """
    from scipy.special import chdtri

    names = scene.rig.names
    shown = np.array(
        [[label(scene, name, who, frame) for frame in range(LAST_FRAME + 1)] for name in names]
    )
    ideal = np.stack([scene.rig[name].undistort(xy) for name, xy in zip(names, shown, strict=True)])
    xyz_m, _ = triangulate(scene.rig.P, ideal)
    off = np.stack([scene.rig[name].project(xyz_m) for name in names]) - shown
    seen = np.isfinite(off).all(axis=-1)
    squared = np.where(seen, (off**2).sum(axis=-1), 0.0).sum(axis=0)
    enough = seen.sum(axis=0) >= 3
    usual = chdtri(2.0 * seen.sum(axis=0)[enough] - 3.0, 0.5)
    return float(np.sqrt(np.median(squared[enough] / usual)))


def jitter_mm(one: Actor) -> Array:
    """Return how far each joint is from the cubic through its neighbours in time [mm]."""
    x = one.xyz_m
    n = len(x) - 4
    cubic = sum(weight * x[k : k + n] for k, weight in enumerate(_CUBIC))
    off: Array = 1e3 * np.linalg.norm(x[2 : 2 + n] - cubic, axis=-1) / _SCALE
    return off[np.isfinite(off)]
