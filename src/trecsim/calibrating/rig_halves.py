"""The halves of a recording of boards, each calibrated alone, against each other."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from trecsim.calibrating.corner_sights import Sight
from trecsim.calibrating.linking import Links
from trecsim.calibrating.rig_fit import BoardProblem, RigFit, fit_rig
from trecsim.calibrating.room_error import PoseCovariance
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import rotation_vector

LEAST_MOMENTS = 8


def halves(
    problem: BoardProblem, links: Links, fit: RigFit, rig: Rig
) -> tuple[float, float, float]:
    """Return by how much the halves differ in degrees and metres, and over what they state."""
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
    change = pose_changes(first[0], second[0])
    scatter = PoseCovariance(np.outer(change, change)).without_common_motion(first[0]).matrix
    left = np.sqrt(np.maximum(np.diag(scatter), 0.0)).reshape(-1, 6)
    stated = first[1].matrix + second[1].matrix
    sd = np.sqrt([
        [np.trace(stated[n : n + 3, n : n + 3]) for n in (6 * camera, 6 * camera + 3)]
        for camera in range(len(left))
    ])  # fmt: skip
    found = np.stack(
        [np.linalg.norm(left[:, :3], axis=1), np.linalg.norm(left[:, 3:], axis=1)], axis=1
    )
    apart = float((found / np.maximum(sd, 1e-12)).max())
    return float(np.rad2deg(found[:, 0].max())), float(found[:, 1].max()), apart * np.sqrt(2)


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
    change = pose_changes(first, second)
    scatter = PoseCovariance(np.outer(change, change)).without_common_motion(first).matrix
    left = np.sqrt(np.maximum(np.diag(scatter), 0.0)).reshape(-1, 6)[:, :3]
    degrees: np.ndarray = np.rad2deg(np.linalg.norm(left, axis=1))
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
