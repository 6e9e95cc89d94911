"""The body as a whole: limbs and ground hold the joints that few cameras see."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.compiler import inner
from trecsim.fusion.kernels.body_equations import Shifts, gather
from trecsim.fusion.kernels.cholesky import cholesky, invert_cholesky, joint_block, solve_cholesky
from trecsim.fusion.kernels.curve import BLOCK, locate, point
from trecsim.fusion.kernels.ground import ground_contact, learn_level
from trecsim.fusion.kernels.information import (
    control_points,
    curve_covariance,
    fold_gaussian,
    right_side,
)
from trecsim.fusion.kernels.lengths import learn
from trecsim.fusion.kernels.small_matrices import invert3
from trecsim.fusion.kernels.track_groups import Bodies, Trajectories
from trecsim.fusion.kernels.usual_directions import add_directions
from trecsim.fusion.tuning import BODY_S, BODY_STEPS, REACH_M2, WEAK_M2


class Moment(NamedTuple):
    """A time on the knot grid, and what the body's say is worth then.

    Attributes
    ----------
    span, weights
        Place of the time on the knot grid; see `locate`.
    white_share
        See `Noise`. Against the body, a curve is only as sure as if nothing in the errors of its
        key points lasted.
    new_share
        Share of what the body says that is new since the last frame set, 0 to 1.
    """

    span: int
    weights: Float64[np.ndarray, "4"]
    white_share: float
    new_share: float


class Workspace(NamedTuple):
    """Arrays that the kernels overwrite, allocated once per call."""

    info: Float64[np.ndarray, "3 3"]
    cov_m2: Float64[np.ndarray, "3 3"]
    zero: Float64[np.ndarray, "3"]
    y: Float64[np.ndarray, "n 3"]
    right: Float64[np.ndarray, " n"]
    step_m: Float64[np.ndarray, " n"]
    rows: Float64[np.ndarray, "3 n"]
    rows_right: Float64[np.ndarray, "3"]


@inner(allocates=True)
def workspace(n):
    """Allocate the workspace for joints of `n` unknowns."""
    return Workspace(
        np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.empty((n, 3)), np.empty(n),
        np.empty(n), np.empty((3, n)), np.empty(3),
    )  # fmt: skip


@inner
def move_joint(joint, shift_m, moment, tmp):
    """Move a joint by `shift_m` at one time, and its trajectory as that implies, in place.

    Parameters
    ----------
    joint
        `Trajectories` of one joint: control points and place change, the information stays.
    shift_m
        How far the joint moves, (3,).
    moment, tmp
        `Moment` and `Workspace`.

    Notes
    -----
    The control points have the covariance ``C = (R^T R)^-1``, the joint at this time ``P = B C
    B^T``. Any information about this joint that moves it by ``d`` moves the mean of the control
    points by ``C B^T P^-1 d = R^-1 Y P^-1 d``, with ``Y = R^-T B^T``.
    """
    R, _, c, x, _ = joint
    span, weights = moment.span, moment.weights
    n, first = R.shape[0], BLOCK * span
    info, y, right, step_m = tmp.info, tmp.y, tmp.right, tmp.step_m
    curve_covariance(R, span, weights, y, tmp.cov_m2)
    invert3(tmp.cov_m2, info)
    a = info[0, 0] * shift_m[0] + info[0, 1] * shift_m[1] + info[0, 2] * shift_m[2]
    b = info[1, 0] * shift_m[0] + info[1, 1] * shift_m[1] + info[1, 2] * shift_m[2]
    d = info[2, 0] * shift_m[0] + info[2, 1] * shift_m[1] + info[2, 2] * shift_m[2]
    for i in range(first):
        right[i] = 0.0
    for i in range(first, n):
        right[i] = y[i, 0] * a + y[i, 1] * b + y[i, 2] * d
    control_points(R, right, step_m)
    for i in range(n):
        c[i] += step_m[i]
    point(c, span, weights, x)


@inner
def apply_body(joint, known, shift_m, moment, tmp):
    """Move a joint as its body says, in place, and keep what of that is new as information.

    Parameters
    ----------
    joint
        `Trajectories` of one joint. Its covariance is the one given the body, with the bound on
        its step, which is removed.
    known
        Information of the joint without its body, as it counts against it, (3, 3).
    shift_m
        How far the body moves the joint, (3,).
    moment, tmp
        `Moment` and `Workspace`.
    """
    R, z, c, x, cov_m2 = joint
    move_joint(joint, shift_m, moment, tmp)
    info, zero, share = tmp.info, tmp.zero, moment.new_share / moment.white_share
    invert3(cov_m2, info)
    least = 1e-6 * moment.new_share * (info[0, 0] + info[1, 1] + info[2, 2])
    for p in range(3):  # how far a joint may go in one step tells nothing of where it is
        info[p, p] -= 1.0 / REACH_M2
    invert3(info, cov_m2)
    for p in range(3):
        zero[p] = 0.0
        for q in range(3):
            info[p, q] = share * (info[p, q] - known[p, q])
    # Only `R` counts here: the right side follows from the control points.
    fold_gaussian(R, z, info, zero, least, x, moment.span, moment.weights, tmp.rows, tmp.rows_right)
    right_side(R, c, z)


@inner
def weak_joints(cov_m2, n_seen, white_share, unknown_of, before_m2, known):
    """Find the joints that need their body; return the number of their unknowns.

    Parameters
    ----------
    cov_m2, n_seen, white_share
        Covariances after the fit, number of cameras that support each joint, and see `Moment`.
    unknown_of
        Result, (joint,): a joint's first unknown, or -1 where it is well known.
    before_m2, known
        Results, (joint, 3, 3): covariances as they count against the body, and the inverse where
        the joint is weak.
    """
    n = 0
    for j in range(unknown_of.shape[0]):
        for p in range(3):
            for q in range(3):
                before_m2[j, p, q] = cov_m2[j, p, q] / white_share
        spread_m2 = before_m2[j, 0, 0] + before_m2[j, 1, 1] + before_m2[j, 2, 2]
        weak = n_seen[j] < 2 or spread_m2 > WEAK_M2
        unknown_of[j] = n if weak else -1
        if weak:
            invert3(before_m2[j], known[j])
            n += 3
    return n


@inner(allocates=True)
def relax_body(person, body, sights, limbs, postures, moment, tmp):
    """Hold by limbs and ground the joints that fewer than two cameras see well, in place.

    Parameters
    ----------
    person
        `Trajectories` of one person, after the fit; changed in place.
    body
        `Bodies` of the same person.
    sights
        Number of cameras that support each joint now, (joint,), and for how long none has [s].
    limbs, postures
        `Limbs` and `Postures`.
    moment, tmp
        `Moment` and `Workspace`.

    Notes
    -----
    All weak joints move together: least squares over their shifts, with each joint's own
    covariance (long along the ray of the camera that sees it) and the limbs' lengths, by
    Gauss-Newton. Where a single camera sees a whole body, its size and the ground on which it
    rests are what fixes its distance.

    A trajectory follows the message of the body, but keeps little of it as information. Otherwise
    the same information would be counted again in each frame set (data incest), and the estimate
    would become certain of a distance that no camera has observed.
    """
    (R, z, c, x, cov_m2), (n_seen, unseen_s) = person, sights
    n_joint = x.shape[0]
    unknown_of = np.empty(n_joint, np.int64)
    before_m2, known = np.empty((n_joint, 3, 3)), np.empty((n_joint, 3, 3))
    n = weak_joints(cov_m2, n_seen, moment.white_share, unknown_of, before_m2, known)
    if n == 0:
        return
    A, b, d = np.empty((n, n)), np.empty(n), np.zeros((n_joint, 3))
    j, rise_m, rise_m2 = ground_contact(x, before_m2, limbs.contact_height_m, body.level)
    height = unknown_of[j] + 2 if j >= 0 and unknown_of[j] >= 0 else -1
    for _ in range(BODY_STEPS):
        shifts = Shifts(x, d, before_m2, known, unknown_of)
        gather(A, b, shifts, limbs, body)
        add_directions(A, b, shifts, postures, unseen_s)
        if height >= 0:
            A[height, height] += 1.0 / rise_m2
            b[height] += rise_m / rise_m2
        cholesky(A)
        solve_cholesky(A, b)
        for i in range(n_joint):
            if unknown_of[i] >= 0:
                for p in range(3):
                    d[i, p] = b[unknown_of[i] + p]
    invert_cholesky(A)
    for i in range(n_joint):
        if unknown_of[i] >= 0:
            joint_block(A, unknown_of[i], cov_m2[i])
            joint = Trajectories(R[i], z[i], c[i], x[i], cov_m2[i])
            apply_body(joint, known[i], d[i], moment, tmp)


@inner(allocates=True)
def constrain_all(tracks, bodies, sights, limbs, postures, white_share, now, elapsed_s):
    """Learn everybody's limb lengths and ground; hold by them what few cameras see, in place.

    Parameters
    ----------
    tracks, bodies
        `Trajectories` after the fit, and `Bodies`; changed in place.
    sights
        Cameras that support each joint now, (track, joint), and for how long none has [s].
    limbs, postures
        `Limbs` and `Postures`.
    white_share
        See `Moment`.
    now
        Time of the frame set, in knots.
    elapsed_s
        Time since the last frame set [s].
    """
    (R, z, c, x, cov_m2), (n_seen, unseen_s) = tracks, sights
    n, weights = R.shape[2], np.empty(4)
    tmp, span = workspace(n), locate(now, n // 3, weights)
    moment = Moment(span, weights, white_share, min(1.0, elapsed_s / BODY_S))
    for k in range(R.shape[0]):
        body = Bodies(bodies.limb_m[k], bodies.limb_m2[k], bodies.level[k])
        learn(x[k], cov_m2[k], n_seen[k], limbs, body, elapsed_s)
        learn_level(x[k], cov_m2[k], n_seen[k], limbs.contact_height_m, body.level, elapsed_s)
        person = Trajectories(R[k], z[k], c[k], x[k], cov_m2[k])
        relax_body(person, body, (n_seen[k], unseen_s[k]), limbs, postures, moment, tmp)
