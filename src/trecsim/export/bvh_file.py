"""BVH: a body of rigid bones with rotations, y up, metres; opens in Blender."""

from pathlib import Path

import numpy as np
import pyarrow as pa
from jaxtyping import Float64
from pyarrow import csv as pa_csv

from trecsim.export.axes import y_up
from trecsim.export.base import About
from trecsim.export.bones import Body, Bone, fitted_body
from trecsim.export.held import held
from trecsim.export.motions import Motion
from trecsim.export.turns3d import calm_order, steady_angles

_END_M = 0.08
_POSITION = "Xposition Yposition Zposition"
_AXES = {"X": "Xrotation", "Y": "Yrotation", "Z": "Zrotation"}
_ROWS_AT_ONCE = 4096


def write_bvh(motion: Motion, path: Path, about: About) -> None:
    """Write one person as BVH; where joints are missing, the last pose is held."""
    one = motion.people[0]
    body = fitted_body(y_up(held(one.xyz_m)).astype(np.float64), motion.rate_hz)
    with path.open("wb") as file:
        file.write(("HIERARCHY\n" + _branch(body, 0, 0)).encode())
        file.write(f"MOTION\nFrames: {len(one.t_s)}\n".encode())
        file.write(f"Frame Time: {1.0 / (motion.rate_hz or 1.0):.9f}\n".encode())
        options = pa_csv.WriteOptions(include_header=False, delimiter=" ", quoting_style="none")
        table = _channels(body)
        names = [str(number) for number in range(table.shape[1])]
        for start in range(0, len(table), _ROWS_AT_ONCE):
            columns = np.ascontiguousarray(table[start : start + _ROWS_AT_ONCE].T)
            pa_csv.write_csv(pa.table(list(columns), names=names), file, write_options=options)


def _branch(body: Body, number: int, depth: int) -> str:
    """Return a bone and all that hangs on it, as the hierarchy of the file."""
    bone = body.bones[number]
    tab = "\t" * depth
    channels = " ".join(_AXES[axis] for axis in _order(bone))
    count, channels = (6, f"{_POSITION} {channels}") if bone.parent < 0 else (3, channels)
    text = (
        f"{tab}{'ROOT' if bone.parent < 0 else 'JOINT'} {bone.name}\n{tab}{{\n"
        f"{tab}\tOFFSET {_numbers(bone.offset_m)}\n{tab}\tCHANNELS {count} {channels}\n"
    )
    children = [index for index, other in enumerate(body.bones) if other.parent == number]
    for child in children:
        text += _branch(body, child, depth + 1)
    if not children:
        end = f"{tab}\t\tOFFSET {_numbers(_end(bone))}\n"
        text += f"{tab}\tEnd Site\n{tab}\t{{\n{end}{tab}\t}}\n"
    return f"{text}{tab}}}\n"


def _order(bone: Bone) -> str:
    return bone.order if bone.turn is None else calm_order(bone.turn, bone.order)


def _end(bone: Bone) -> Float64[np.ndarray, " 3"]:
    """Return the end of a bone without children: hands go on, feet and faces point forward."""
    if bone.name.endswith("Hand"):
        return np.asarray(bone.offset_m / np.linalg.norm(bone.offset_m) * _END_M)
    return np.array([0.0, 0.0, 2 * _END_M if bone.name.endswith("Foot") else 0.01])


def _numbers(values: Float64[np.ndarray, " 3"]) -> str:
    return " ".join(f"{value:.6f}" for value in values.tolist())


def _channels(body: Body) -> Float64[np.ndarray, "frame channel"]:
    """Return the channels in the order in which the hierarchy lists the bones."""
    frames = len(body.root_m)
    columns = [np.round(body.root_m, 6)]
    for number in _listed(body, 0):
        bone = body.bones[number]
        if bone.turn is None:
            columns.append(np.zeros((frames, 3)))
        else:
            columns.append(np.round(np.degrees(steady_angles(bone.turn, _order(bone))), 5))
    return np.concatenate(columns, axis=1) + 0.0


def _listed(body: Body, number: int) -> list[int]:
    children = [index for index, other in enumerate(body.bones) if other.parent == number]
    return [number, *(one for child in children for one in _listed(body, child))]
