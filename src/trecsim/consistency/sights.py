"""Sampled frame sets as arrays: torsos in the images, and the people tracked at that time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.consistency.thresholds import Thresholds
from trecsim.geometry import Rig
from trecsim.geometry.view import rays
from trecsim.skeleton import COCO17
from trecsim.values import FrameSet, Poses2D, Snapshot

TORSO = [
    COCO17.joints.index(name)
    for name in ("left_shoulder", "right_shoulder", "left_hip", "right_hip")
]
"""The joints that are looked at: they are found best, and move least."""


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """What is kept of one image.

    Attributes
    ----------
    cam
        Index of the camera in the rig.
    t_s
        Time of the image [s].
    torso_px
        Left and right shoulder, left and right hip in the raw image [px].
    """

    cam: int
    t_s: float
    torso_px: Float64[np.ndarray, "detection 4 2"]


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """What is kept of a sampled frame set, and of the people tracked at that time.

    Attributes
    ----------
    t_s
        Time of the frame set [s].
    looks
        The images.
    people_s
        Time of `people_m` [s].
    people_m
        The middle of the shoulders and that of the hips of everybody [m].
    velocity_mps
        How fast everybody moves [m/s].
    """

    t_s: float
    looks: tuple[Look, ...]
    people_s: float
    people_m: Float64[np.ndarray, "person 2 3"]
    velocity_mps: Float64[np.ndarray, "person 3"]


@dataclass(frozen=True, slots=True, eq=False)
class Sights:
    """Several moments as arrays; where there is nothing, NaN.

    Attributes
    ----------
    view_s
        When each camera's image was taken, after the people's time [s].
    torso_px
        Left and right shoulder, left and right hip in the raw image [px].
    people_m, velocity_mps
        As for `Moment`.
    """

    view_s: Float64[np.ndarray, "moment cam"]
    torso_px: Float64[np.ndarray, "moment cam detection 4 2"]
    people_m: Float64[np.ndarray, "moment person 2 3"]
    velocity_mps: Float64[np.ndarray, "moment person 3"]


def moment(
    frame_set: FrameSet,
    place: Mapping[str, int],
    snapshot: Snapshot,
    limit: Thresholds,
) -> Moment:
    """Return what is kept of a frame set.

    Parameters
    ----------
    frame_set
        What the cameras saw.
    place
        Index of each camera in the rig.
    snapshot
        The people at its time.
    limit
        Of more detections in an image, those with the highest scores are kept; of more people,
        the first.
    """
    looks = tuple(
        Look(place[view.camera], view.t_s, _torsos(view, limit.most_detections))
        for view in frame_set.views
    )
    people_m = _middles(snapshot.xyz_m[: limit.most_people, TORSO])
    velocity_mps = np.nan_to_num(snapshot.velocity_mps[: limit.most_people, TORSO].mean(axis=1))
    return Moment(frame_set.t_s, looks, snapshot.t_s, people_m, velocity_mps)


def _torsos(view: Poses2D, most: int) -> Float64[np.ndarray, "detection 4 2"]:
    torsos = view.xy_px[:, TORSO]
    if len(torsos) > most:
        torsos = torsos[np.argsort(-view.person_score, kind="stable")[:most]]
    return torsos


def gather(moments: Sequence[Moment], cameras: int) -> Sights:
    """Return moments as arrays."""
    detections = max([1, *(len(look.torso_px) for one in moments for look in one.looks)])
    people = max([1, *(len(one.people_m) for one in moments)])
    sights = Sights(
        np.full((len(moments), cameras), np.nan),
        np.full((len(moments), cameras, detections, len(TORSO), 2), np.nan),
        np.full((len(moments), people, 2, 3), np.nan),
        np.full((len(moments), people, 3), np.nan),
    )
    for m, one in enumerate(moments):
        sights.people_m[m, : len(one.people_m)] = one.people_m
        sights.velocity_mps[m, : len(one.people_m)] = one.velocity_mps
        for look in one.looks:
            sights.view_s[m, look.cam] = look.t_s - one.people_s
            sights.torso_px[m, look.cam, : len(look.torso_px)] = look.torso_px
            sights.torso_px[m, look.cam, len(look.torso_px) :] = np.nan
    return sights


def _middles(torso: Float64[np.ndarray, "*batch 4 n"]) -> Float64[np.ndarray, "*batch 2 n"]:
    return np.asarray(0.5 * (torso[..., ::2, :] + torso[..., 1::2, :]))


def torso_rays(
    torso_px: Float64[np.ndarray, "moment cam detection 4 2"], rig: Rig
) -> Float64[np.ndarray, "moment cam detection 4 3"]:
    """Return unit directions in the world of the rays through torsos' joints."""
    return np.stack([rays(camera, torso_px[:, c]) for c, camera in enumerate(rig)], axis=1)


def middle_rays(torso: Float64[np.ndarray, "*batch 4 3"]) -> Float64[np.ndarray, "*batch 2 3"]:
    """Return unit directions of the middle of the shoulders and that of the hips."""
    middle = _middles(torso)
    return np.asarray(middle / np.linalg.norm(middle, axis=-1, keepdims=True))
