"""The halves of a recording of boards, each calibrated alone, against each other."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from trecsim.calibrating.corner_sights import Sight
from trecsim.calibrating.linking import Links
from trecsim.calibrating.rig_fit import BoardProblem, RigFit, fit_rig
from trecsim.calibrating.room_error import PoseCovariance, without_common_motion
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import rotation_vector

LEAST_MOMENTS = 8
LEAST_M2 = 1e-18  # a variance of exact corners


def halves(
    problem: BoardProblem, links: Links, fit: RigFit, rig: Rig
) -> tuple[float, float, float]:
    """Return by how much the halves differ in degrees, metres, and beside what they state."""
    unknown = (float("nan"),) * 3
    moments = sorted({sight.moment for sight in fit.sights})
    if len(moments) < LEAST_MOMENTS or len(rig) < 2:
        return unknown
    cut = moments[len(moments) // 2]
    early = [sight for sight in fit.sights if sight.moment < cut]
    late = [sight for sight in fit.sights if sight.moment >= cut]
    if not all(_connects(half, fit, problem) for half in (early, late)):
        return unknown
    made = []
    begin = _from_whole(links, fit)
    for half in (early, late):
        part = replace(problem, sights=tuple(half), timed=False)
        try:
            fitted = fit_rig(part, begin)
        except (CalibrationError, np.linalg.LinAlgError):
            return unknown
        of_half = fitted.rig(part)
        made.append((of_half, fitted.covariance(of_half)))
    return _difference(made[0], made[1])


def _from_whole(links: Links, fit: RigFit) -> Links:
    """Return the links with the poses that all moments gave: a half starts from there.

    Half of the moments may link cameras badly; that says nothing of whether a camera moved.
    """
    poses = dict(zip(fit.numbers, fit.adjusted.state.T_cam_world, strict=True))
    return replace(links, T_cam_root=tuple(poses.get(n) for n in range(len(links.T_cam_root))))


def _difference(
    first: tuple[Rig, PoseCovariance], second: tuple[Rig, PoseCovariance]
) -> tuple[float, float, float]:
    """Return the largest turn and shift between two rigs, and how much that is for all numbers.

    Notes
    -----
    The last is ``sqrt(d' C^-1 d / n)`` of the changes d of all poses, with the covariance C that
    both rigs state for it and the n numbers that a common motion of all cameras leaves: about 1 if
    no camera moved. Errors of neighbouring cameras are not independent; a difference that is small
    for each number may be impossible for all of them together.
    """
    rig, free = first[0], 6 * (len(first[0]) - 1)
    keep = without_common_motion(rig)
    change = keep @ pose_changes(rig, second[0])
    stated = keep @ (first[1].matrix + second[1].matrix) @ keep.T
    values, axes = np.linalg.eigh(stated)
    along = axes[:, -free:].T @ change
    apart = np.sqrt(np.mean(along**2 / np.maximum(values[-free:], LEAST_M2)))
    turns, shifts = np.moveaxis(change.reshape(-1, 2, 3), 1, 0)
    most_rad, most_m = (float(np.linalg.norm(part, axis=1).max()) for part in (turns, shifts))
    return float(np.rad2deg(most_rad)), most_m, float(apart)


def pose_changes(first: Rig, second: Rig) -> np.ndarray:
    """Return by how much the cameras of the second rig are turned and shifted from the first.

    Returns
    -------
    Six numbers per camera, as `PoseCovariance` has them; small changes only.
    """
    rows = []
    for a, b in zip(first, second, strict=True):
        turn = rotation_vector(b.T_cam_world[:3, :3] @ a.T_cam_world[:3, :3].T)
        rows.append(np.concatenate((turn, b.position_m - a.position_m)))
    return np.concatenate(rows)


def turns_deg(first: Rig, second: Rig) -> np.ndarray:
    """Return how far each camera is turned, without the common motion [degrees]."""
    change = without_common_motion(first) @ pose_changes(first, second)
    degrees: np.ndarray = np.rad2deg(np.linalg.norm(change.reshape(-1, 6)[:, :3], axis=1))
    return degrees


def _connects(sights: Sequence[Sight], fit: RigFit, problem: BoardProblem) -> bool:
    """Return whether the sights alone connect all cameras, with some moments for each."""
    part = {n: n for n in fit.numbers}
    seen: dict[tuple[int, int], list[int]] = {}
    count = dict.fromkeys(fit.numbers, 0)
    for sight in sights:
        seen.setdefault(problem.place(sight), []).append(sight.camera)
    for cameras in seen.values():
        if len(set(cameras)) < 2:
            continue
        for camera in set(cameras):
            count[camera] += 1
            old, new = part[camera], part[cameras[0]]
            part = {n: new if p == old else p for n, p in part.items()}
    return len(set(part.values())) == 1 and min(count.values()) >= 3
