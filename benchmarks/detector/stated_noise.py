"""How large the errors of key points are, each camera's own, by the noise that the tracker states.

A joint is triangulated from all cameras that show it, in one moment, without any track; what the
cameras share goes into its place. What is left over, by the noise that the tracker states of each
key point, is 1 where that noise is right. What all key points of a camera have in common is taken
off before: that is the calibration. Medians are compared, as some key points are false.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import chdtri

from detector.key_points import GATE, LIMBS, median_of_known
from harness.demo_video import Recorded
from harness.shelf_recording import read_shelf, truth_of
from trecsim.fusion import FusionSettings
from trecsim.fusion.body import key_point_sigma_m
from trecsim.fusion.kernels.prefilter import score_to_sigma_scale
from trecsim.geometry import Rig
from trecsim.geometry.triangulation import triangulate
from trecsim.lab.evaluation.assignment import best_pairs
from trecsim.skeleton import COCO17
from trecsim.values import Poses2D

Array = npt.NDArray[np.float64]

KINDS = {
    "face": slice(0, 5), "shoulder": slice(5, 7), "elbow": slice(7, 9), "wrist": slice(9, 11),
    "hip": slice(11, 13), "knee": slice(13, 15), "ankle": slice(15, 17),
}  # fmt: skip
BANDS = ((0.85, 1.0), (0.6, 0.85), (0.4, 0.6), (0.15, 0.4))
FEWEST_VIEWS = 3
ROUNDS = 4  # each takes off what the places found have not taken up
FEWEST = 50  # moments, for a figure to be worth stating


@dataclass(frozen=True, slots=True, eq=False)
class Views:
    """One person in all cameras.

    Attributes
    ----------
    xy_px
        Key points as found, NaN where missing, (camera, frame, joint, 2).
    score
        Their scores, (camera, frame, joint).
    """

    xy_px: Array
    score: Array


def of_actor(scene: Recorded, who: str) -> Views:
    """Return an actor of the sample recording in all cameras, told apart in 2D."""
    some = next(iter(scene.labels[scene.rig.names[0]].values()))
    labels = np.stack(
        [scene.labels[name].get(who, np.full_like(some, np.nan)) for name in scene.rig.names]
    )
    return Views(labels[..., :2], np.nan_to_num(labels[..., 2]))


def on_shelf(folder: object) -> tuple[Rig, list[Views]]:
    """Return the annotated people of Shelf in all cameras."""
    shelf = read_shelf(str(folder))
    truth = truth_of(shelf.annotation)
    people, frames = truth.xyz_m.shape[:2]
    views = [
        Views(
            np.full((len(shelf.rig), frames, 17, 2), np.nan), np.zeros((len(shelf.rig), frames, 17))
        )
        for _ in range(people)
    ]
    for poses in shelf.poses:
        frame = int(np.argmin(np.abs(truth.t_s - poses.t_s)))
        camera = shelf.rig.index(poses.camera)
        truth_px = shelf.rig[poses.camera].project(truth.xyz_m[:, frame, LIMBS])
        for person, detection in paired(truth_px, poses):
            views[person].xy_px[camera, frame] = poses.xy_px[detection]
            views[person].score[camera, frame] = poses.score[detection]
    return shelf.rig, views


def paired(truth_px: Array, poses: Poses2D) -> list[tuple[int, int]]:
    """Return people of an image with their detections, as `detector.key_points` pairs them."""
    error_px = np.linalg.norm(poses.xy_px[:, LIMBS] - truth_px[:, None], axis=-1)
    cost = median_of_known(error_px) / np.ptp(truth_px[..., 1], axis=1)[:, None]
    return list(best_pairs(cost, GATE))


def figures(rig: Rig, people: list[Views], settings: FusionSettings) -> dict[str, float]:
    """Return error over stated noise by kind of joint and by score; NaN where little is known."""
    shift_px = np.zeros((len(rig), 1, 1, 2))
    for _ in range(ROUNDS):
        off = [_fit(rig, one, shift_px, settings)[0] for one in people]
        together = np.concatenate([one.reshape(len(rig), -1, 2) for one in off], axis=1)
        shift_px = shift_px + np.nanmedian(together, axis=1)[:, None, None]
    found = [_fit(rig, one, shift_px, settings)[1:] for one in people]
    ratio2 = np.concatenate([ratio2 for ratio2, _ in found])
    score = np.concatenate([score for _, score in found])
    out = {name: _size(ratio2[:, joints]) for name, joints in KINDS.items()}
    for least, most in BANDS:
        out[f"mean score {least:g} to {most:g}"] = _size(ratio2[(score > least) & (score <= most)])
    out["all"] = _size(ratio2)
    return out


def _size(ratio2: Array) -> float:
    """Return the size of the errors by what is stated, from the median of their squares."""
    known = ratio2[np.isfinite(ratio2)]
    return float(np.sqrt(np.median(known))) if len(known) >= FEWEST else np.nan


def _fit(
    rig: Rig, one: Views, shift_px: Array, settings: FusionSettings
) -> tuple[Array, Array, Array]:
    """Triangulate a person.

    Returns
    -------
    off_px
        Key points less the place found, (camera, frame, joint, 2) [px].
    ratio2
        Sum of their squares over the stated variances, by its median if those are right, (frame,
        joint); NaN with fewer than three views.
    score
        Mean score of the views, (frame, joint).
    """
    seen_px = one.xy_px - shift_px
    ideal = np.stack([c.undistort(px) for c, px in zip(rig, seen_px, strict=True)])
    seen = np.isfinite(ideal).all(axis=-1) & (one.score >= settings.min_score)
    weight = seen.astype(np.float64)
    for _ in range(2):
        xyz_m, _ = triangulate(rig.P, ideal, weight)
        variance = _stated_px2(rig, xyz_m, one.score, settings)
        weight = np.where(seen & np.isfinite(variance), 1.0 / variance, 0.0)
    off_px = seen_px - np.stack([c.project(xyz_m) for c in rig])
    squared = np.where(weight > 0, (off_px**2).sum(axis=-1) * weight, 0.0).sum(axis=0)
    views = (weight > 0).sum(axis=0)
    usual = chdtri(np.maximum(2.0 * views - 3.0, 1.0), 0.5)  # the place takes up three numbers
    enough = (views >= FEWEST_VIEWS) & np.isfinite(xyz_m).all(axis=-1)
    score = (one.score * seen).sum(axis=0) / np.maximum(views, 1)
    off_px = np.where((enough & seen)[..., None], off_px, np.nan)
    return off_px, np.where(enough, squared / usual, np.nan), score


def _stated_px2(rig: Rig, xyz_m: Array, score: Array, settings: FusionSettings) -> Array:
    """Return the variance per axis that the tracker states of each key point."""
    scale = np.vectorize(score_to_sigma_scale)(score, settings.good_score)
    focal_px = np.array([0.5 * (c.K[0, 0] + c.K[1, 1]) for c in rig])[:, None, None]
    depth_m = np.stack([xyz_m @ c.T_cam_world[2, :3] + c.T_cam_world[2, 3] for c in rig])
    sigma_px = focal_px * key_point_sigma_m(COCO17, settings) * scale / depth_m
    out: Array = sigma_px**2 + settings.floor_px**2
    return out
