"""Constants of a tracking run, as arrays for the kernels: cameras, body, settings."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int64

from trecsim.fusion import body, camera_errors, limb_directions, undistortion, visibility
from trecsim.fusion.body import UsualBody
from trecsim.fusion.kernels import (
    Bones,
    CameraErrors,
    Cameras,
    Lenses,
    Limbs,
    Limits,
    Motion,
    Noise,
    Postures,
    Ruler,
    Silhouette,
    Undistortion,
)
from trecsim.fusion.settings import FusionSettings
from trecsim.geometry import Rig
from trecsim.skeleton import Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """Constants of one tracking run.

    Attributes
    ----------
    rig, skeleton, settings
        Arguments of the run.
    cam_of
        Index of each camera by its name.
    undistortion
        Parameters that undistort key points, per camera.
    cameras
        Projections of the cameras, and their viewing rays.
    errors
        What residuals tell of the cameras so far; the kernels write to it.
    lenses, silhouette
        Parameters that decide which camera has whom in view, and who hides whom.
    noise
        Measurement model of the detector.
    motion
        What is assumed of how people move.
    limits
        Settings that decide which tracks are reported and which end.
    bones
        The limbs of the skeleton and their usual lengths, for births.
    body
        Prior knowledge of the distances between joints.
    limbs
        The same, for the kernels.
    ruler
        What measures how far away somebody is whom one camera sees.
    postures
        Which directions limbs take.
    torso
        The joints whose mean is the person's position: shoulders and hips.
    """

    rig: Rig
    skeleton: Skeleton
    settings: FusionSettings
    cam_of: Mapping[str, int]
    undistortion: Undistortion
    cameras: Cameras
    errors: CameraErrors
    lenses: Lenses
    silhouette: Silhouette
    noise: Noise
    motion: Motion
    limits: Limits
    bones: Bones
    body: UsualBody
    limbs: Limbs
    ruler: Ruler
    postures: Postures
    torso: Int64[np.ndarray, " joint_of_torso"]


def build(
    rig: Rig, skeleton: Skeleton, settings: FusionSettings, errors: CameraErrors | None = None
) -> Model:
    """Derive the constants of a run; `errors` is what residuals will tell of the cameras."""
    usual = body.usual_body(skeleton)
    torso = _torso(skeleton)
    return Model(
        rig=rig,
        skeleton=skeleton,
        settings=settings,
        cam_of={name: i for i, name in enumerate(rig.names)},
        undistortion=undistortion.undistortion(rig),
        cameras=camera_errors.uncorrected(rig),
        errors=camera_errors.CameraErrors(rig).known if errors is None else errors,
        lenses=visibility.lenses(rig),
        silhouette=visibility.silhouette(skeleton),
        noise=_noise(skeleton, settings),
        motion=_motion(skeleton, settings, torso),
        limits=Limits(
            settings.confirm_s, settings.death_s, settings.single_view_death_s, settings.duplicate_m
        ),
        bones=Bones(np.ascontiguousarray(usual.joints[usual.bone]), usual.length_m[usual.bone]),
        body=usual,
        limbs=Limbs(
            usual.joints,
            usual.slack_m**2,
            body.contact_height_m(skeleton),
            body.chain(skeleton, usual),
        ),
        ruler=body.ruler(skeleton, usual),
        postures=limb_directions.postures(skeleton),
        torso=torso,
    )


def _torso(skeleton: Skeleton) -> Int64[np.ndarray, " joint_of_torso"]:
    torso = [i for i, name in enumerate(skeleton.joints) if name.endswith(("shoulder", "hip"))]
    return np.array(torso or range(len(skeleton.joints)), np.int64)


def _motion(
    skeleton: Skeleton, s: FusionSettings, torso: Int64[np.ndarray, " joint_of_torso"]
) -> Motion:
    return Motion(
        stiffness=body.stiffness(skeleton, s),
        torso=torso,
        own_memory=math.exp(-s.knot_s / s.velocity_memory_s),
        coasting_memory=math.exp(-s.knot_s / s.coasting_memory_s),
        error_memory_s=s.error_memory_s,
    )


def _noise(skeleton: Skeleton, s: FusionSettings) -> Noise:
    return Noise(
        sigma_m=body.key_point_sigma_m(skeleton, s),
        mirror=np.array(skeleton.mirror, np.int64),
        common_m2=body.common_sigma_m(skeleton, s) ** 2,
        floor_px=float(s.floor_px),
        odds_m2=(1.0 - s.outlier_share) * s.outlier_area_m2 / (2.0 * math.pi * s.outlier_share),
        outlier_share=float(s.outlier_share),
        log_flip=math.log(s.flip_share / (1.0 - s.flip_share)),
        tail=float(s.tail_freedom),
        white_share=float(s.white_share),
        bias_share=float(s.bias_share),
    )
