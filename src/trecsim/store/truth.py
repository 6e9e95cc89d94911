"""Ground truth of synthetic scenes, `truth.npz`."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.skeleton import COCO17
from trecsim.store.atomic import atomic_write
from trecsim.store.limits import FARTHEST_M, LATEST_S
from trecsim.store.names import TRUTH
from trecsim.store.npz import Shapes, read_arrays

_TIMES_AT_ONCE = 10_000
_AXES = f"(person, time, {len(COCO17.joints)}, 3)"


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Ground truth: the exact joints of all people.

    Attributes
    ----------
    t_s
        Times, increasing, at least one [s].
    xyz_m
        Joints, COCO-17 in files; NaN while a person is absent [m].
    """

    t_s: Float64[np.ndarray, " time"]
    xyz_m: Float64[np.ndarray, "person time joint 3"]


def write_truth(
    path: Path,
    t_s: Float64[np.ndarray, " time"],
    xyz_m: Float64[np.ndarray, "person time joint 3"],
) -> None:
    """Write a truth file.

    Parameters
    ----------
    path
        The file, usually ``truth.npz``.
    t_s
        Times [s].
    xyz_m
        Joints, NaN while a person is absent [m].

    Raises
    ------
    SetupError
        The disk is full or cannot be written.
    """
    with atomic_write(path, "wb") as file:
        np.savez_compressed(file, t_s=t_s, xyz_m=xyz_m)


def read_truth(path: Path | str) -> Truth:
    """Read a truth file.

    Parameters
    ----------
    path
        The file, or the directory of a synthetic scene with its ``truth.npz``.

    Raises
    ------
    InputError
        It is missing, not a truth file, or inconsistent.
    """
    path = Path(path)
    path = path / TRUTH if path.is_dir() else path
    arrays = read_arrays(path, ("t_s", "xyz_m"), "truth file", _shape_faults)
    t_s, xyz_m = arrays["t_s"], arrays["xyz_m"]
    faults = [*_time_faults(t_s), *_joint_faults(xyz_m)]
    if faults:
        raise InputError(f"{path}: " + "; ".join(faults))
    return Truth(t_s, xyz_m)


def _shape_faults(shapes: Shapes) -> Iterator[str]:
    t_s, xyz_m = shapes["t_s"], shapes["xyz_m"]
    if len(t_s) != 1:
        yield f"t_s: expected one axis (time), found the shape {t_s}"
    elif t_s == (0,):
        yield "the truth is empty: it has no moment at all"
    if len(xyz_m) != 4 or xyz_m[3] != 3:
        yield f"xyz_m: expected the shape {_AXES}, found {xyz_m}"
        return
    if xyz_m[2] != len(COCO17.joints):
        yield (
            f"xyz_m: expected the {len(COCO17.joints)} joints of {COCO17.name}, found {xyz_m[2]}: "
            "another skeleton; convert it first"
        )
    if len(t_s) == 1 and xyz_m[1] != t_s[0]:
        yield f"t_s has {t_s[0]} times and xyz_m {xyz_m[1]}; they must be the same"


def _time_faults(t_s: Float64[np.ndarray, " time"]) -> Iterator[str]:
    wrong = np.flatnonzero(~(np.abs(t_s) <= LATEST_S))
    if len(wrong):
        yield (
            f"t_s[{wrong[0]}] is {t_s[wrong[0]]}; every time must be a finite number up to "
            f"{LATEST_S:g} s"
        )
        return
    back = np.flatnonzero(np.diff(t_s) <= 0)
    if len(back):
        first = int(back[0])
        kind = "repeats" if t_s[first + 1] == t_s[first] else "runs back from"
        yield (
            f"t_s[{first + 1}] = {t_s[first + 1]:.9g} s {kind} t_s[{first}] = {t_s[first]:.9g} s; "
            "times must increase"
        )


def _joint_faults(xyz_m: Float64[np.ndarray, "person time 17 3"]) -> Iterator[str]:
    for number, person_m in enumerate(xyz_m):
        for begin in range(0, len(person_m), _TIMES_AT_ONCE):  # bounds the memory of the masks
            faults = list(_faults_in(person_m[begin : begin + _TIMES_AT_ONCE]))
            if faults:
                time, joint, text = faults[0]
                yield f"xyz_m[{number}, {begin + time}, {joint}] ({COCO17.joints[joint]}) {text}"
                return


def _faults_in(xyz_m: Float64[np.ndarray, "time 17 3"]) -> Iterator[tuple[int, int, str]]:
    """Yield the first impossible joint of each kind: time, joint, fault."""
    unknown = np.isnan(xyz_m)
    wrong = {
        "is infinite": np.isinf(xyz_m).any(axis=-1),
        f"is farther than {FARTHEST_M / 1e3:g} km; the unit is metres": (
            np.abs(xyz_m) > FARTHEST_M
        ).any(axis=-1),
        "must be all there or all NaN": unknown.any(axis=-1) & ~unknown.all(axis=-1),
    }
    for text, mask in wrong.items():
        if mask.any():
            time, joint = np.argwhere(mask)[0]
            yield int(time), int(joint), text
