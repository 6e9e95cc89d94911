"""Clips of recorded motion, transferred to another body at any place on the floor.

A clip is an ``.npz`` file with ``joints`` (time, 17 to 200, 3) [m], z up, the first 17 of them
COCO-17, and ``fps``, its frames per second.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.lab.simulation.actions import FARTHEST_M, Point
from trecsim.lab.simulation.body_shape import JOINTS, Body
from trecsim.lab.simulation.frame_times import even
from trecsim.lab.simulation.paths import STEP_S, distances_m, interpolated, smooth
from trecsim.lab.simulation.pose import Joints, Pose, blend, cut, joined, pose_of
from trecsim.lab.simulation.postures import STAND, Posture
from trecsim.lab.simulation.rotations import Place, unit
from trecsim.lab.simulation.sampled import between
from trecsim.store.npz import Shapes, read_arrays

MOST_FRAMES, MOST_JOINTS = 1_000_000, 200
FEWEST_FPS, MOST_FPS = 1.0, 1000.0
# Nose, eyes and ears seen from the head of those recorded: forward, left, up [m].
FACE_M = np.array(
    [
        [0.105, 0.0, 0.06],
        [0.085, 0.032, 0.095],
        [0.085, -0.032, 0.095],
        [0.0, 0.075, 0.075],
        [0.0, -0.075, 0.075],
    ]
)
UPRIGHT = 0.6  # vertical share of the trunk's direction from which a person is upright
OVERLAP_S = 0.25  # overlap of repetitions
STRIDES_S = 0.4  # standard deviation of the smoothing that removes strides from the path


@dataclass(frozen=True, slots=True, eq=False)
class Take:
    """Recorded motion of one person.

    Attributes
    ----------
    fps
        Frames per second.
    xyz_m
        COCO-17 joints [m], z up, the floor at 0.
    """

    fps: float
    xyz_m: Joints

    def cut(self, from_s: float, to_s: float | None) -> "Take":
        """Return the part of the take from `from_s` to `to_s`, or to its end.

        Raises
        ------
        InputError
            If the take is too short for that.
        """
        end = len(self.xyz_m) if to_s is None else round(to_s * self.fps) + 1
        part_m = self.xyz_m[round(from_s * self.fps) : end]
        if len(part_m) < 2:
            seconds = (len(self.xyz_m) - 1) / self.fps
            raise InputError(f"clip: nothing is left from {from_s:g} s on, it has {seconds:.2f} s")
        return Take(self.fps, part_m)


def read_clip(path: Path) -> Take:
    """Read a clip of real motion.

    Raises
    ------
    InputError
        The file is not a clip, or its numbers are invalid.
    """
    arrays = read_arrays(Path(path), ("joints", "fps"), "clip of motion", _shape_faults)
    fps = float(arrays["fps"].reshape(()))
    xyz_m = arrays["joints"][:, :JOINTS]
    faults = []
    if not FEWEST_FPS <= fps <= MOST_FPS:
        faults.append(f"fps: expected {FEWEST_FPS:g} to {MOST_FPS:g}, found {fps:g}")
    if not np.isfinite(xyz_m).all():
        faults.append("joints: expected finite numbers, found NaN or infinity; fill the gaps first")
    elif np.abs(xyz_m).max() > FARTHEST_M:
        faults.append(f"joints: found one farther than {FARTHEST_M:g} m; the unit is metres")
    elif not 0.3 <= _leg_m(xyz_m) <= 1.5:
        faults.append(f"joints: expected legs of 0.3 to 1.5 m, found {_leg_m(xyz_m):.3g} m")
    if faults:
        raise InputError(f"{path}: " + "; ".join(faults))
    return Take(fps, xyz_m)


def _leg_m(xyz_m: Joints) -> float:
    """Return the initial length of the left leg [m]."""
    return float(np.linalg.norm(np.diff(xyz_m[0, [11, 13, 15]], axis=0), axis=1).sum())


def _shape_faults(shapes: Shapes) -> Iterator[str]:
    """Yield the faults in the shapes of the arrays of a clip."""
    shape, fps = shapes["joints"], shapes["fps"]
    if len(shape) != 3 or not JOINTS <= shape[1] <= MOST_JOINTS or shape[2] != 3:
        yield f"joints: expected the shape time x {JOINTS} to {MOST_JOINTS} x 3, found {shape}"
    elif not 2 <= shape[0] <= MOST_FRAMES:
        yield f"joints: expected 2 to {MOST_FRAMES} frames, found {shape[0]}"
    if fps not in ((), (1,)):
        yield f"fps: expected a single number, found the shape {fps}"


def posed(take: Take, body: Body) -> Pose:
    """Return recorded motion transferred to another body, one pose per `STEP_S`.

    It begins over the origin and faces +x. Ways over the floor grow with the legs, so that feet
    that stand keep standing.
    """
    seconds = (len(take.xyz_m) - 1) / take.fps
    entry = np.arange(int(seconds / STEP_S) + 1) * STEP_S * take.fps
    xyz_m = between(take.xyz_m, entry)
    pose = pose_of(xyz_m, FACE_M)
    scale = body.leg_m / _leg_m(take.xyz_m)
    upright = pose.chest[:, 2, 2] > UPRIGHT
    soles_m = scale * pose.ankles_m[..., 2].min(axis=1)
    raised_m = body.ankle_m - np.percentile(soles_m[upright], 5) if upright.any() else 0.0
    shift_m = np.array([0.0, 0.0, raised_m])
    pose = replace(
        pose, root_m=scale * pose.root_m + shift_m, ankles_m=scale * pose.ankles_m + shift_m
    )
    start = pose.root_m[0]
    return _moved(pose, np.array([start[0], start[1], _heading(pose, 0)]), np.zeros(3))


def _heading(pose: Pose, entry: int) -> float:
    """Return the direction faced, or that after getting up [rad]."""
    up, ahead = pose.chest[entry, :, 2], pose.chest[entry, :, 0]
    if up[2] < UPRIGHT:
        ahead = -up if ahead[2] > 0 else up
    return float(np.arctan2(ahead[1], ahead[0]))


def _moved(
    pose: Pose, old: Float64[np.ndarray, "*time 3"], new: Float64[np.ndarray, "*time 3"]
) -> Pose:
    """Return poses moved so that x, y, heading `old` become `new`."""
    turn_rad = np.broadcast_to(new[..., 2] - old[..., 2], len(pose.root_m))
    c, s, zero = np.cos(turn_rad), np.sin(turn_rad), np.zeros(len(turn_rad))
    turn = np.stack((c, -s, zero, s, c, zero, zero, zero, zero + 1), axis=1).reshape(-1, 3, 3)
    flat = np.array([1.0, 1.0, 0.0])
    old_m, new_m = np.atleast_2d(old * flat), np.atleast_2d(new * flat)
    return replace(
        pose,
        root_m=np.einsum("tab,tb->ta", turn, pose.root_m - old_m) + new_m,
        ankles_m=np.einsum("tab,tsb->tsa", turn, pose.ankles_m - old_m[:, None]) + new_m[:, None],
        hips=turn @ pose.hips,
        chest=turn @ pose.chest,
        head=turn @ pose.head,
    )


def stays_in(pose: Pose, entry: int) -> Posture:
    """Return the posture closest to one entry of a pose: standing or lying."""
    if pose.chest[entry, 2, 2] > UPRIGHT:
        return STAND
    return Posture("back" if pose.chest[entry, 2, 0] > 0 else "front")


def place_of(pose: Pose, entry: int, body: Body) -> Place:
    """Return the standing place that belongs to a pose."""
    x_m, y_m, _ = pose.root_m[entry]
    hips = Place(float(x_m), float(y_m), _heading(pose, entry))
    return hips.ahead(
        {"stand": 0.0, "back": 0.6, "front": -1.0}[stays_in(pose, entry).name] * body.leg_m
    )


def looped(pose: Pose, times: int, body: Body) -> Pose:
    """Return a motion repeated, each repetition starting where the last one ended."""
    over = min(round(OVERLAP_S / STEP_S), len(pose.root_m) // 2)
    share = even(np.arange(over) / max(over, 1))
    start = place_of(pose, 0, body)
    parts, again = [cut(pose, slice(0, len(pose.root_m) - over))], pose
    for _ in range(times - 1):
        here = place_of(again, len(again.root_m) - over, body)
        following = _moved(pose, _row(start), _row(here))
        seam = blend(
            cut(again, slice(len(again.root_m) - over, None)), cut(following, slice(over)), share
        )
        parts += [seam, cut(following, slice(over, len(following.root_m) - over))]
        again = following
    return joined([*parts, cut(again, slice(len(again.root_m) - over, None))])


def _row(place: Place) -> Float64[np.ndarray, " 3"]:
    return np.array([place.x_m, place.y_m, place.heading_rad])


def carried(pose: Pose, place: Place, along_m: Sequence[Point], body: Body) -> Pose:
    """Return poses moved to a place, and bent along way points if there are any.

    The way points are followed over the length of the recorded path.
    """
    pose = _moved(pose, _row(place_of(pose, 0, body)), _row(place))
    if not along_m:
        return pose
    own_m = smooth(pose.root_m[:, :2], STRIDES_S)
    gone_m = distances_m(own_m)
    corners_m = np.array([own_m[0], *along_m], dtype=float)
    ends_m = distances_m(corners_m)
    way_m = interpolated(gone_m, ends_m, corners_m)
    leg = np.clip(np.searchsorted(ends_m, gone_m, side="right") - 1, 0, len(corners_m) - 2)
    towards = unit(np.column_stack((np.diff(corners_m, axis=0), np.zeros(len(corners_m) - 1))))[leg]
    # Beyond the last way point the path goes straight on.
    way_m += np.maximum(gone_m - ends_m[-1], 0.0)[:, None] * towards[:, :2]
    turn = smooth(np.unwrap(np.arctan2(towards[:, 1], towards[:, 0])), STRIDES_S)
    ahead = np.gradient(own_m, axis=0)
    own = smooth(np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0])), STRIDES_S)
    return _moved(
        pose, np.column_stack((own_m, own)), np.column_stack((smooth(way_m, STRIDES_S), turn))
    )
