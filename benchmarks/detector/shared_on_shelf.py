"""What all cameras share of a detector's errors: OpenPose on Shelf, and the simulated detector."""

from pathlib import Path

import numpy as np

from detector import openpose_on_shelf as on_shelf
from detector.key_points import LIMBS
from detector.shared_errors import figures, pair
from harness.shelf_recording import read_shelf, truth_of
from trecsim.lab.simulation.detector import Footage, detect
from trecsim.lab.simulation.detector_errors import Detector

FRAMES = 300


def recorded(folder: Path | str) -> dict[str, float]:
    """Return the figures of OpenPose on the annotated frames of Shelf.

    Parameters
    ----------
    folder
        Where the recording is; see :func:`harness.shelf_recording.read_shelf`.
    """
    shelf = read_shelf(folder)
    truth = truth_of(shelf.annotation)
    truth_m = np.ascontiguousarray(np.moveaxis(truth.xyz_m[:, :, LIMBS], 0, 1))
    seen_px = np.full((*truth_m.shape[:2], len(shelf.rig), *truth_m.shape[2:3], 2), np.nan)
    for poses in shelf.poses:
        frame = int(np.argmin(np.abs(truth.t_s - poses.t_s)))
        if np.isfinite(truth_m[frame]).any():
            truth_px = shelf.rig[poses.camera].project(truth_m[frame])
            seen_px[frame, :, shelf.rig.index(poses.camera)] = pair(truth_px, poses)
    return figures(truth.t_s, truth_m, seen_px, tuple(shelf.rig))


def simulated(detector: Detector, seed: int) -> dict[str, float]:
    """Return the figures of a simulated detector in a recording like Shelf.

    Parameters
    ----------
    detector
        Its noise, misses and false positives.
    seed
        The same seed gives the same.
    """
    source = np.random.SeedSequence(seed)
    of_people, *of_cameras = source.spawn(1 + len(on_shelf.STANDS_M))
    common_seed = int(source.generate_state(1, np.uint64)[0])
    t_s = np.arange(FRAMES) / on_shelf.FPS
    xyz_m, stature_m = on_shelf.people(t_s, np.random.default_rng(of_people))
    truth_m = np.ascontiguousarray(np.moveaxis(xyz_m[:, :, LIMBS], 0, 1))
    cameras = tuple(on_shelf.camera(number) for number in range(len(of_cameras)))
    seen_px = np.full((*truth_m.shape[:2], len(cameras), 12, 2), np.nan)
    for number, (camera, own) in enumerate(zip(cameras, of_cameras, strict=True)):
        footage = Footage(camera, t_s, t_s, xyz_m, stature_m, (), common_seed)
        for frame, poses in enumerate(detect(footage, detector, np.random.default_rng(own))):
            seen_px[frame, :, number] = pair(camera.project(truth_m[frame]), poses)
    return figures(t_s, truth_m, seen_px, cameras)
