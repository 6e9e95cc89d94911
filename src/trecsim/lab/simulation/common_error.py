"""Errors that all cameras share: joints that every camera sees in the same wrong place.

An estimator puts a joint where annotators marked it, and clothes and the pose decide where that is:
hips under a coat, for one. This error does not shrink with the number of cameras. It has three
parts: one of each person, constant in the axes of the trunk; one that is a smooth function of the
pose as the cameras see it (directions of the limbs, and where the person faces); and one that
wanders. The recording to which they were fitted is described in
``docs/reference/simulated-detector.md``.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation.body_shape import JOINTS
from trecsim.lab.simulation.noise import ornstein_uhlenbeck
from trecsim.lab.simulation.rotations import unit

STEP_S = 0.08  # coarse on purpose: the wandering part adds no jitter
# Poses whose directions differ by this much, as unit vectors, have nearly the same error: its
# correlation is 0.6 there, and 0.14 at twice the distance.
ALIKE = 0.4
WAVES = 24  # number of waves that make up the function of the pose
# Limbs whose directions decide on the error of each joint.
_FACE, _ARM, _LEG = ((3, 0), (4, 0)), ((5, 7), (7, 9)), ((11, 13), (13, 15))
_LIMBS = np.array(
    [_FACE] * 5
    + [
        [(first + side, last + side) for first, last in limbs]
        for limbs in (_ARM, _ARM, _ARM, _LEG, _LEG, _LEG)
        for side in (0, 1)
    ]
)

Joints = Float64[np.ndarray, "time person 17 3"]


@dataclass(frozen=True, slots=True)
class CommonError:
    """Size of the errors that all cameras share.

    Attributes
    ----------
    up_m
        Mean of each joint, the same for all people, from the hips towards the shoulders [m].
    spread_m
        Standard deviation about that mean, over people, poses and time, per axis and joint [m].
    person
        Share of that variance that is constant for a person, per joint.
    pose
        Share of the rest that depends on the pose; what remains wanders.
    wander_s
        Correlation time of what wanders [s].
    """

    up_m: tuple[float, ...]
    spread_m: tuple[float, ...]
    person: tuple[float, ...]
    pose: float
    wander_s: float

    def __bool__(self) -> bool:
        """Return whether there is any error."""
        return any(self.up_m) or any(self.spread_m)


def with_common_error(
    t_s: Float64[np.ndarray, " time"], xyz_m: Joints, size: CommonError, rng: np.random.Generator
) -> Joints:
    """Return the joints where the cameras agree to see them.

    Parameters
    ----------
    t_s
        Times; before 0 nothing wanders [s].
    xyz_m
        Joints of all people, NaN while absent [m].
    size
        How large the error is.
    rng
        Random numbers. The same generator gives the same error at a time, whatever the other times
        are, so that cameras agree.
    """
    of_people, of_poses, of_time = rng.spawn(3)
    person = np.array(size.person)[:, None]
    axes = _body_axes(xyz_m)
    own = of_people.standard_normal((xyz_m.shape[1], JOINTS, 3))
    wandering = _wandering(t_s, xyz_m.shape[1], size.wander_s, of_time)
    in_body = np.sqrt(person) * own + np.sqrt((1.0 - person) * (1.0 - size.pose)) * wandering
    in_body *= np.array(size.spread_m)[:, None]
    in_body[..., 2] += np.array(size.up_m)
    of_pose = np.sqrt((1.0 - person) * size.pose) * _of_pose(xyz_m, axes[..., 0], of_poses)
    of_pose *= np.array(size.spread_m)[:, None]
    shown_m: Joints = xyz_m + np.einsum("tpia,tpja->tpji", axes, in_body) + of_pose
    return shown_m


def _of_pose(
    xyz_m: Joints, facing: Float64[np.ndarray, "time person 3"], rng: np.random.Generator
) -> Joints:
    """Return smooth random functions of the pose with unit variance, of each person.

    Notes
    -----
    Sums of waves with normal frequencies and amplitudes approximate a Gaussian process whose
    correlation at the distance d is exp(-d^2 / 2 l^2), with l = `ALIKE` (Rahimi and Recht, 2007).
    """
    limbs = unit(xyz_m[..., _LIMBS[..., 1], :] - xyz_m[..., _LIMBS[..., 0], :])
    people, parts = xyz_m.shape[1], limbs.shape[-2] + 1
    waves = rng.standard_normal((people, WAVES, JOINTS, parts, 3)) / ALIKE
    tall = rng.standard_normal((people, WAVES, 2, JOINTS, 3)) / np.sqrt(WAVES)
    total = np.zeros(xyz_m.shape)
    for wave in range(WAVES):
        phase = np.einsum("tpjba,pjba->tpj", limbs, waves[:, wave, :, :-1])
        phase += np.einsum("tpa,pja->tpj", facing, waves[:, wave, :, -1])
        total += np.cos(phase)[..., None] * tall[:, wave, 0]
        total += np.sin(phase)[..., None] * tall[:, wave, 1]
    return total


def _wandering(
    t_s: Float64[np.ndarray, " time"], people: int, tau_s: float, rng: np.random.Generator
) -> Joints:
    """Return unit processes, made on a grid from 0 and interpolated linearly."""
    grid_s = np.arange(int(np.ceil(t_s.max(initial=0.0) / STEP_S)) + 2) * STEP_S
    grid = ornstein_uhlenbeck(rng, grid_s, tau_s, people, JOINTS, 3)
    step = np.maximum(t_s, 0.0) / STEP_S
    before = np.floor(step).astype(np.intp)
    share = (step - before)[:, None, None, None]
    at: Joints = (1.0 - share) * grid[before] + share * grid[before + 1]
    return at


def _body_axes(xyz_m: Joints) -> Float64[np.ndarray, "time person 3 axis"]:
    """Return the forward, left and up axes of each trunk, as columns."""
    up = unit(xyz_m[..., 5:7, :].mean(axis=-2) - xyz_m[..., 11:13, :].mean(axis=-2))
    forward = unit(np.cross(xyz_m[..., 11, :] - xyz_m[..., 12, :], up))
    return np.stack((forward, np.cross(up, forward), up), axis=-1)
