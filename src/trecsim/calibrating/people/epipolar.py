"""Robust epipolar geometry of two cameras, from the joints that both see.

A pair of cameras that see the same body has five unknowns: its rotation and the direction of its
baseline. Bodies are upright and cameras roughly so. From which side the second camera looks is
unknown at first, so `SIDES` directions around the body are tried at once.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

Turns = Float64[np.ndarray, "trial 3 3"]
"""Rotations from the first camera to the second, one for each guess."""
Shifts = Float64[np.ndarray, "trial 3"]
"""Translations from the first camera to the second, of length 1."""
Rays = Float64[np.ndarray, "point 3"]
"""Viewing rays, with z = 1."""

SIDES = 16  # first guesses, around the body
# Scale of the robust weights at each Gauss-Newton step: wide at first, as guesses are far off.
STAGES = (0.06, 0.06, 0.03, 0.03, 0.02, 0.02, 0.014, 0.014, 0.01, 0.01, 0.01, 0.01)
NOISE = STAGES[-1]  # error of a key point over its distance: 3 to 5 cm at 4 m, bias included
LITTLE = 1e-6  # step of the numerical derivatives; information that keeps equations solvable


@dataclass(frozen=True, slots=True, eq=False)
class Epipolar:
    """The pose of a second camera relative to a first one, up to scale.

    Attributes
    ----------
    R, t
        Take points of the first camera to those of the second; the length of `t`, unknown, is 1.
    support
        Number of key points that fit, each counted with its weight.
    turn_sd_rad
        Standard deviation of the rotation [rad].
    """

    R: Float64[np.ndarray, "3 3"]
    t: Float64[np.ndarray, " 3"]
    support: float
    turn_sd_rad: float


def epipolar(p: Rays, q: Rays, R: Turns, t: Shifts) -> Epipolar | None:
    """Return the epipolar geometry that the most key points fit; None if no guess converges.

    Parameters
    ----------
    p, q
        Rays of the same joints in both cameras.
    R, t
        First guesses.
    """
    for noise in STAGES:
        off, J = _linearised(p, q, R, t)
        weight = trust(off, noise)
        normal = np.einsum("kni,kn,knj->kij", J, weight, J)
        normal += (1e-4 * len(p) * noise**2 + LITTLE) * np.eye(5)
        step = -np.linalg.solve(normal, np.einsum("kni,kn,kn->ki", J, weight, off)[..., None])
        R, t = _moved(R, t, step[..., 0])
    weight = trust(sampson(p, q, R, t), NOISE)
    score = weight.sum(axis=1) * (in_front(p, q, R, t, weight) > 0.5)
    best = int(np.argmax(score))
    if not score[best] > 0.0:
        return None
    _, J = _linearised(p, q, R[[best]], t[[best]])
    normal = np.einsum("ni,n,nj->ij", J[0], weight[best], J[0]) / NOISE**2
    sd = np.sqrt(np.trace(np.linalg.inv(normal + LITTLE * np.eye(5))[:3, :3]))
    return Epipolar(R[best], t[best], float(score[best]), float(sd))


def trust(off: Float64[np.ndarray, "*n"], noise: float = NOISE) -> Float64[np.ndarray, "*n"]:
    """Return the weights of residuals (Geman and McClure)."""
    return np.asarray(1.0 / (1.0 + (off / (2.0 * noise)) ** 2) ** 2)


def sampson(p: Rays, q: Rays, R: Turns, t: Shifts) -> Float64[np.ndarray, "trial point"]:
    """Return the signed Sampson distance of each pair of rays, in the planes z = 1."""
    E = np.cross(t[:, None, :], np.swapaxes(R, 1, 2)).swapaxes(1, 2)
    by_p, by_q = p @ E.swapaxes(1, 2), q @ E
    length2 = (by_p[..., :2] ** 2).sum(axis=-1) + (by_q[..., :2] ** 2).sum(axis=-1)
    found: Float64[np.ndarray, "trial point"] = (q * by_p).sum(axis=-1) / np.sqrt(length2 + 1e-12)
    return found


def in_front(
    p: Rays, q: Rays, R: Turns, t: Shifts, weight: Float64[np.ndarray, "trial point"]
) -> Float64[np.ndarray, " trial"]:
    """Return the weighted share of key points that lie in front of both cameras."""
    near, far = depths(p, q, R, t)
    there = (near > 0.0) & (far > 0.0)
    share: Float64[np.ndarray, " trial"] = (weight * there).sum(axis=1) / weight.sum(axis=1)
    return share


def depths(
    p: Rays, q: Rays, R: Turns, t: Shifts
) -> tuple[Float64[np.ndarray, "trial point"], Float64[np.ndarray, "trial point"]]:
    """Return how far along its rays each point lies from both cameras, in units of the baseline."""
    a = p @ R.swapaxes(1, 2)  # depth_p a + t = depth_q q
    aa, qq, aq = (a * a).sum(-1), (q * q).sum(-1), (a * q).sum(-1)
    at, qt = (a * t[:, None]).sum(-1), (q * t[:, None]).sum(-1)
    det = aa * qq - aq * aq + 1e-12
    return (aq * qt - qq * at) / det, (aa * qt - aq * at) / det


def rays_of(z: Float64[np.ndarray, "*place 2"]) -> Float64[np.ndarray, "*place 3"]:
    """Return the rays through places in the plane z = 1."""
    return np.concatenate((z, np.ones((*z.shape[:-1], 1))), axis=-1)


def _linearised(
    p: Rays, q: Rays, R: Turns, t: Shifts
) -> tuple[Float64[np.ndarray, "trial point"], Float64[np.ndarray, "trial point 5"]]:
    """Return residuals and their derivatives by a turn and by the direction of the baseline."""
    here = sampson(p, q, R, t)
    columns = [
        (sampson(p, q, *_moved(R, t, np.tile(one, (len(R), 1)))) - here) / LITTLE
        for one in LITTLE * np.eye(5)
    ]
    return here, np.stack(columns, axis=-1)


def _moved(R: Turns, t: Shifts, step: Float64[np.ndarray, "trial 5"]) -> tuple[Turns, Shifts]:
    """Return the geometry after a small step, at most half a radian."""
    length = np.linalg.norm(step, axis=1, keepdims=True)
    step = step * np.minimum(1.0, 0.5 / np.maximum(length, 1e-12))
    first = np.cross(t, np.eye(3)[np.argmin(np.abs(t), axis=1)])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    t = t + step[:, 3:4] * first + step[:, 4:5] * np.cross(t, first)
    return _turned(step[:, :3]) @ R, t / np.linalg.norm(t, axis=1, keepdims=True)


def _turned(w: Shifts) -> Turns:
    """Return rotations by vectors [rad]."""
    angle = np.linalg.norm(w, axis=1)[:, None, None] + 1e-12
    zero = np.zeros(len(w))
    K = np.stack(
        [zero, -w[:, 2], w[:, 1], w[:, 2], zero, -w[:, 0], -w[:, 1], w[:, 0], zero], axis=1
    ).reshape(-1, 3, 3)
    turned: Turns = (
        np.eye(3) + np.sin(angle) / angle * K + (1.0 - np.cos(angle)) / angle**2 * (K @ K)
    )
    return turned
