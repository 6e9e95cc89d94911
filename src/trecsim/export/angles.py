"""Joint angles from joint centres: knee, hip, elbow and trunk.

Axes follow the recommendations of the International Society of Biomechanics (Wu and Cavanagh 1995,
Wu et al. 2002, 2005): X to the front, Y up, Z to the right. Seventeen joint centres do not show
everything that these define. There is no foot, no hand, and no marker of the pelvis besides the
hips, so that

- the pelvis is taken to be upright in the trunk: its Z axis is the line from the left to the right
  hip, its Y axis the part of the line from the hips to the shoulders at right angles to it;
- rotations of thigh, shank and arm about their own axes are not known and not given.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.skeleton import COCO17

Vectors = Float64[np.ndarray, "frame 3"]
Angles = Float64[np.ndarray, " frame"]


class AngleName(NamedTuple):
    """One angle.

    Attributes
    ----------
    name
        In our tables.
    opensim
        Coordinate of OpenSim's full-body models (Rajagopal et al. 2016).
    sign
        Of that coordinate against ours.
    """

    name: str
    opensim: str
    sign: float = 1.0


ANGLES = (
    AngleName("left_hip_flexion", "hip_flexion_l"),
    AngleName("right_hip_flexion", "hip_flexion_r"),
    AngleName("left_hip_adduction", "hip_adduction_l"),
    AngleName("right_hip_adduction", "hip_adduction_r"),
    AngleName("left_knee_flexion", "knee_angle_l"),
    AngleName("right_knee_flexion", "knee_angle_r"),
    AngleName("left_elbow_flexion", "elbow_flex_l"),
    AngleName("right_elbow_flexion", "elbow_flex_r"),
    AngleName("trunk_flexion", "lumbar_extension", -1.0),
    AngleName("trunk_bending", "lumbar_bending"),
    AngleName("trunk_rotation", "lumbar_rotation"),
)


def joint_angles_deg(
    xyz_m: Float64[np.ndarray, "frame joint 3"],
) -> Float64[np.ndarray, "frame angle"]:
    """Return the angles of `ANGLES` [degrees]; NaN where a joint they need is missing.

    Parameters
    ----------
    xyz_m
        COCO-17 with z up [m].

    Notes
    -----
    Knee and elbow: the angle by which shank and forearm deviate from the straight continuation of
    thigh and upper arm; 0 is straight. Hip: direction of the thigh in the axes of the pelvis;
    flexion is its angle in the XY plane to the front, adduction its angle to that plane towards
    the middle. Trunk: the line from hips to shoulders against the vertical, in the vertical plane
    to the front of the hips (flexion) and across it (bending, to the right positive); rotation is
    that of the shoulders against the hips about the trunk, to the left positive.

    Examples
    --------
    >>> import numpy as np
    >>> bent = np.zeros((1, 17, 3))
    >>> bent[0, [11, 13, 15]] = [[0, 0.1, 0.9], [0.4, 0.1, 0.9], [0.4, 0.1, 0.5]]  # left leg, sits
    >>> round(float(joint_angles_deg(bent)[0, 4]))
    90
    """
    at = {name: xyz_m[:, number] for number, name in enumerate(COCO17.joints)}
    hips = (at["left_hip"] + at["right_hip"]) / 2
    shoulders = (at["left_shoulder"] + at["right_shoulder"]) / 2
    trunk = _unit(shoulders - hips)
    right = _unit(at["right_hip"] - at["left_hip"])
    up = _across(trunk, right)
    front = np.cross(up, right)
    found = {}
    for side, inward in (("left", 1.0), ("right", -1.0)):
        thigh = _unit(at[f"{side}_knee"] - at[f"{side}_hip"])
        found[f"{side}_hip_flexion"] = np.arctan2(_dot(thigh, front), -_dot(thigh, up))
        found[f"{side}_hip_adduction"] = np.arcsin(np.clip(inward * _dot(thigh, right), -1, 1))
        found[f"{side}_knee_flexion"] = _bend(at, side, ("hip", "knee", "ankle"))
        found[f"{side}_elbow_flexion"] = _bend(at, side, ("shoulder", "elbow", "wrist"))
    found |= _trunk(trunk, right, _unit(at["right_shoulder"] - at["left_shoulder"]))
    return np.asarray(np.degrees(np.stack([found[one.name] for one in ANGLES], axis=1)))


def _trunk(trunk: Vectors, right: Vectors, shoulders: Vectors) -> dict[str, Angles]:
    vertical = np.broadcast_to(np.array([0.0, 0.0, 1.0]), trunk.shape)
    aside = _across(right, vertical)
    ahead = np.cross(vertical, aside)
    hips, girdle = _across(right, trunk), _across(shoulders, trunk)
    return {
        "trunk_flexion": np.arctan2(_dot(trunk, ahead), trunk[:, 2]),
        "trunk_bending": np.arcsin(np.clip(_dot(trunk, aside), -1.0, 1.0)),
        "trunk_rotation": np.arctan2(_dot(np.cross(hips, girdle), trunk), _dot(hips, girdle)),
    }


def _bend(at: dict[str, Vectors], side: str, joints: tuple[str, str, str]) -> Angles:
    start, middle, end = (at[f"{side}_{joint}"] for joint in joints)
    upper, lower = middle - start, end - middle
    crossing = np.linalg.norm(np.cross(upper, lower), axis=1)
    return np.asarray(np.arctan2(crossing, _dot(upper, lower)))


def _dot(a: Vectors, b: Vectors) -> Angles:
    return np.asarray(np.sum(a * b, axis=1))


def _unit(vectors: Vectors) -> Vectors:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(length > 1e-9, length, np.nan))


def _across(vectors: Vectors, axis: Vectors) -> Vectors:
    """Return the unit vectors of what is left of `vectors` at right angles to unit vectors."""
    return _unit(vectors - _dot(vectors, axis)[:, None] * axis)
