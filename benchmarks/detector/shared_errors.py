"""The part of a detector's errors that all cameras share, joint by joint, in 3D.

Where at least three cameras see a joint, one offset of the joint explains their errors best: that
is what they share. What remains is the cameras' own. Offsets are taken along the axes of the trunk.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float64

from detector.key_points import GATE, LIMBS, TYPES, median_of_known
from trecsim.geometry import Camera
from trecsim.lab.evaluation.assignment import best_pairs
from trecsim.values import Poses2D

LEAST_SCORE = 0.3
FEWEST_VIEWS = 3
STEP_M = 1e-3
# Key points that are off by more than this from what the others say count ever less [m].
TAIL_M, FREEDOM, ROUNDS = 0.025, 3.0, 10
AGREEING, GOOD = 0.8, 0.5  # weights from which on a view agrees, and is not an outlier
SOON_S, LATER_S = 0.2, 1.0
ALIKE = 0.25  # poses whose directions differ by less, as unit vectors
ARM, LEG = (0, 2, 4), (6, 8, 10)  # left shoulder, elbow, wrist; left hip, knee, ankle

Truth = Float64[np.ndarray, "frame person 12 3"]
Seen = Float64[np.ndarray, "frame person camera 12 2"]
Offsets = Float64[np.ndarray, "frame person 12 3"]


def pair(
    truth_px: Float64[np.ndarray, "person 12 2"], poses: Poses2D
) -> Float64[np.ndarray, "person 12 2"]:
    """Return the key points found of each person in an image; NaN where there is no good one."""
    found_px = np.full(truth_px.shape, np.nan)
    limbs_px = poses.xy_px[:, LIMBS]
    error_px = np.linalg.norm(limbs_px - truth_px[:, None], axis=-1)
    cost = median_of_known(error_px) / np.ptp(truth_px[..., 1], axis=1)[:, None]
    for person, detection in best_pairs(cost, GATE):
        good = poses.score[detection, LIMBS] >= LEAST_SCORE
        found_px[person, good] = limbs_px[detection, good]
    return found_px


def figures(
    t_s: Float64[np.ndarray, " frame"], truth_m: Truth, seen_px: Seen, cameras: Sequence[Camera]
) -> dict[str, float]:
    """Return the size and the nature of what the cameras share, by name.

    Parameters
    ----------
    t_s
        Times of the frames [s].
    truth_m
        Limb joints, NaN where a person is absent [m].
    seen_px
        The same in the images as they were found, NaN where missing; see `pair` [px].
    cameras
        The cameras.
    """
    offset_m, own_m = _offsets(truth_m, seen_px, cameras)
    axes = _trunk(truth_m)
    shared_m = np.einsum("fpja,fpak->fpjk", offset_m, axes)
    of_person_m = np.nanmean(shared_m, axis=0)
    about_m = shared_m - of_person_m
    values = {}
    for number, name in enumerate(TYPES):
        both = slice(2 * number, 2 * number + 2)
        up_m = float(np.nanmean(shared_m[:, :, both, 2]))
        person_m2 = np.nanmean((of_person_m[:, both] - [0.0, 0.0, up_m]) ** 2)
        varying_m2 = np.nanmean(about_m[:, :, both] ** 2)
        values[f"{name}: mean, upwards cm"] = 100 * up_m
        values[f"{name}: of the person cm"] = 100 * float(np.sqrt(person_m2))
        values[f"{name}: varying cm"] = 100 * float(np.sqrt(varying_m2))
        values[f"{name}: of each camera cm"] = 100 * float(np.sqrt(np.nanmean(own_m[:, :, both])))
    values |= _likeness(t_s, truth_m, offset_m - np.nanmean(offset_m, axis=0))
    return values


def _offsets(
    truth_m: Truth, seen_px: Seen, cameras: Sequence[Camera]
) -> tuple[Offsets, Float64[np.ndarray, "frame person 12"]]:
    """Return the shared offset of each joint [m], and the variance of the cameras' own [m^2]."""
    rows, errors_m = [], []
    for number, camera in enumerate(cameras):
        at_px = camera.project(truth_m)
        moved_px = [camera.project(truth_m + STEP_M * axis) for axis in np.eye(3)]
        depth_m = np.linalg.norm(truth_m - camera.position_m, axis=-1)[..., None]
        px_m = depth_m / camera.K[0, 0]
        rows.append(np.stack([(one - at_px) / STEP_M for one in moved_px], -1) * px_m[..., None])
        errors_m.append((seen_px[:, :, number] - at_px) * px_m)
    J, error_m = np.stack(rows, axis=-3), np.stack(errors_m, axis=-2)
    seen = np.isfinite(error_m).all(axis=-1) & np.isfinite(J).all(axis=(-2, -1))
    J, error_m = np.where(seen[..., None, None], J, 0.0), np.where(seen[..., None], error_m, 0.0)
    enough = seen.sum(axis=-1) >= FEWEST_VIEWS
    weight = seen.astype(np.float64)
    for _ in range(ROUNDS):
        matrix = np.einsum("...c,...cia,...cib->...ab", weight, J, J)
        slope = np.einsum("...c,...cia,...ci->...a", weight, J, error_m)
        matrix[~enough] = np.eye(3)
        offset_m = np.linalg.solve(matrix, slope[..., None])[..., 0]
        left_m = error_m - np.einsum("...cia,...a->...ci", J, offset_m)
        far = (left_m**2).sum(axis=-1) / TAIL_M**2
        weight = seen * (FREEDOM + 2.0) / (FREEDOM + far)
    enough &= (weight > AGREEING).sum(axis=-1) >= 2
    good = weight > GOOD
    freedom = np.maximum(2 * good.sum(axis=-1) - 3, 1)
    own_m2 = ((left_m**2).sum(axis=-1) * good).sum(axis=-1) / freedom
    return np.where(enough[..., None], offset_m, np.nan), np.where(enough, own_m2, np.nan)


def _trunk(truth_m: Truth) -> Float64[np.ndarray, "frame person 3 axis"]:
    """Return the forward, left and up axes of each trunk, as columns."""
    up = _unit(truth_m[:, :, 0:2].mean(axis=2) - truth_m[:, :, 6:8].mean(axis=2))
    forward = _unit(np.cross(truth_m[:, :, 6] - truth_m[:, :, 7], up))
    return np.stack((forward, np.cross(up, forward), up), axis=-1)


def _unit(vector: Float64[np.ndarray, "*batch 3"]) -> Float64[np.ndarray, "*batch 3"]:
    direction: Float64[np.ndarray, "*batch 3"] = vector / np.linalg.norm(
        vector, axis=-1, keepdims=True
    )
    return direction


def _likeness(
    t_s: Float64[np.ndarray, " frame"], truth_m: Truth, about_m: Offsets
) -> dict[str, float]:
    """Return correlations of what varies: soon after, and later in the same pose and in others."""
    facing = _trunk(truth_m)[..., 0]
    products: dict[str, list[float]] = {"soon": [], "pose": [], "other": []}
    squares: dict[str, list[float]] = {name: [] for name in products}
    apart_s = np.abs(t_s[:, None] - t_s)
    for limb in (ARM, LEG):
        for side in (0, 1):
            first, middle, last = (truth_m[:, :, joint + side] for joint in limb)
            pose = np.concatenate((_unit(middle - first), _unit(last - middle), facing), axis=-1)
            for person in range(truth_m.shape[1]):
                for joint in limb:
                    error_m = about_m[:, person, joint + side]
                    known = np.isfinite(error_m).all(axis=-1)
                    if known.sum() < 2:
                        continue
                    error_m, gap_s = error_m[known], apart_s[np.ix_(known, known)]
                    at = pose[known, person]
                    distance = np.linalg.norm(at[:, None] - at, axis=-1)
                    later = gap_s > LATER_S
                    _gather(products, squares, "soon", error_m, np.abs(gap_s - SOON_S) < 0.02)
                    _gather(products, squares, "pose", error_m, later & (distance < ALIKE))
                    _gather(products, squares, "other", error_m, later & (distance > 3 * ALIKE))
    said = {
        "soon": f"correlation after {SOON_S:g} s",
        "pose": f"after more than {LATER_S:g} s, same pose",
        "other": f"after more than {LATER_S:g} s, other pose",
    }
    return {
        text: sum(products[name]) / total if (total := sum(squares[name])) > 0 else np.nan
        for name, text in said.items()
    }


def _gather(
    products: dict[str, list[float]],
    squares: dict[str, list[float]],
    name: str,
    error_m: Float64[np.ndarray, "moment 3"],
    pairs: Bool[np.ndarray, "moment moment"],
) -> None:
    dot = error_m @ error_m.T
    square = np.diagonal(dot)
    products[name].append(float(dot[pairs].sum()))
    squares[name].append(float((0.5 * (square[:, None] + square))[pairs].sum()))
