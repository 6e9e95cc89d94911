"""The simulated detector compared with a real one: OpenPose on Shelf.

Shelf is a recording of up to four people about a shelf, seen by five cameras of 1032 x 776 pixels.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float64

from detector.key_points import LIMBS, Sights, figures, sights_of, together
from harness.shelf_recording import read_shelf, truth_of
from trecsim.geometry.camera import Camera
from trecsim.lab.simulation.body_shape import body
from trecsim.lab.simulation.camera_placement import look_at
from trecsim.lab.simulation.detector import Footage, detect
from trecsim.lab.simulation.detector_errors import Detector
from trecsim.lab.simulation.paths import FloorPath, through
from trecsim.lab.simulation.walkers import poses as poses_at
from trecsim.lab.simulation.walkers import walker

MEASURED = {
    "person found": 0.955,
    "shoulder missing": 0.032,
    "shoulder error p50 px": 13.0,
    "shoulder error p90 px": 27.0,
    "shoulder error p99 px": 59.0,
    "elbow missing": 0.174,
    "elbow error p50 px": 9.0,
    "elbow error p90 px": 24.0,
    "elbow error p99 px": 83.0,
    "wrist missing": 0.225,
    "wrist error p50 px": 14.0,
    "wrist error p90 px": 31.0,
    "wrist error p99 px": 100.0,
    "hip missing": 0.014,
    "hip error p50 px": 22.0,
    "hip error p90 px": 39.0,
    "hip error p99 px": 59.0,
    "knee missing": 0.027,
    "knee error p50 px": 11.0,
    "knee error p90 px": 27.0,
    "knee error p99 px": 73.0,
    "ankle missing": 0.048,
    "ankle error p50 px": 9.0,
    "ankle error p90 px": 20.0,
    "ankle error p99 px": 114.0,
    "error p50 of height": 0.031,
    "error p90 of height": 0.068,
    "error p99 of height": 0.203,
    "error p50 px, score 0.8 to 1.0": 10.0,
    "error p50 px, score 0.6 to 0.8": 15.0,
    "error p50 px, score 0.4 to 0.6": 26.0,
    "correlation over 1": 0.92,
    "correlation over 2": 0.87,
    "correlation over 5": 0.77,
    "correlation over 10": 0.69,
    "correlation over 25": 0.61,
    "white part px": 1.5,
    "left and right swapped": 0.004,
}
"""OpenPose on Shelf against the annotated ground truth; the simulated detector is tuned to these.

They were measured once, by other code than :func:`recorded`, which finds other shares of what is
rare (joints missing, 99th percentiles, swaps). Lags are in frames.
"""

SIZE_PX, FOCAL_PX = (1032, 776), 1090.0
STANDS_M = ((-1.9, -2.9, 1.1), (-3.5, 0.3, 1.0), (-1.8, 3.0, 2.5), (1.6, 3.2, 1.4), (3.6, 0.0, 1.4))
# Three people walk in circles, each about their own place.
PLACES_M = ((-0.8, -0.6), (0.85, -0.4), (0.0, 0.95))
STATURES_M = (1.69, 1.81, 1.75)
CIRCLE_M = 0.35
FPS = 25.0
# Images for shares and sizes lie far enough apart to be new; those that tell how errors last come
# in bursts. Both as numbers of images at 25 a second.
STILLS, BURSTS = ((0,), 76), ((0, 1, 2, 5, 10, 25), 101)
ROUND_S = 30.0  # people start again; neither number of images above divides it


def simulated(detector: Detector, seed: int) -> dict[str, float]:
    """Return the figures of a simulated detector; five cameras stand around three people.

    Parameters
    ----------
    detector
        Its noise, misses and false positives.
    seed
        The same seed gives the same.
    """
    of_stills, of_bursts = np.random.SeedSequence(seed).spawn(2)
    stills = _sights(detector, *STILLS, 100, of_stills.spawn(20))
    return figures(stills, _sights(detector, *BURSTS, 20, of_bursts.spawn(4)))


def recorded(folder: Path | str) -> dict[str, float]:
    """Return the figures of OpenPose on all annotated frames of Shelf.

    Parameters
    ----------
    folder
        Where the recording is; see :func:`harness.shelf_recording.read_shelf`.

    Raises
    ------
    InputError
        A file is missing or wrong.
    """
    shelf = read_shelf(folder)
    truth = truth_of(shelf.annotation)
    names = shelf.rig.names
    parts = []
    for poses in shelf.poses:
        frame = int(np.argmin(np.abs(truth.t_s - poses.t_s)))
        limbs_m = truth.xyz_m[:, frame, LIMBS]
        if np.isfinite(limbs_m).any():
            truth_px = shelf.rig[poses.camera].project(limbs_m)
            parts.append(sights_of(names.index(poses.camera), frame, SIZE_PX, truth_px, poses))
    sights = together(parts)
    return figures(sights, sights)


def _sights(
    detector: Detector,
    burst: tuple[int, ...],
    apart: int,
    times: int,
    runs: list[np.random.SeedSequence],
) -> Sights:
    """Return what a detector makes of images in bursts, so many times in each run."""
    frame = (np.arange(times)[:, None] * apart + burst).ravel()
    parts = []
    for run, of_run in enumerate(runs):
        of_people, *of_cameras = of_run.spawn(1 + len(STANDS_M))
        common_seed = int(of_run.generate_state(1, np.uint64)[0])
        xyz_m, stature_m = people(frame / FPS % ROUND_S, np.random.default_rng(of_people))
        for number, own in enumerate(of_cameras):
            footage = Footage(
                camera(number), frame / FPS, frame / FPS, xyz_m, stature_m, (), common_seed
            )
            truth_px = footage.camera.project(xyz_m[:, :, LIMBS])
            for i, seen in enumerate(detect(footage, detector, np.random.default_rng(own))):
                place = number + len(STANDS_M) * run
                parts.append(sights_of(place, int(frame[i]), SIZE_PX, truth_px[:, i], seen))
    return together(parts)


def camera(number: int) -> Camera:
    """Return one of five cameras that stand as those of Shelf do."""
    K = np.array([[FOCAL_PX, 0, SIZE_PX[0] / 2], [0, FOCAL_PX, SIZE_PX[1] / 2], [0, 0, 1.0]])
    T_cam_world = look_at(np.array(STANDS_M[number]), np.array([0.0, 0.0, 0.95]))
    return Camera(str(number), SIZE_PX, K, T_cam_world)


def people(
    t_s: Float64[np.ndarray, " time"], rng: np.random.Generator
) -> tuple[Float64[np.ndarray, "person time 17 3"], Float64[np.ndarray, " person"]]:
    """Return the joints of three people who walk in circles, and their statures [m]."""
    statures = [body(stature_m, rng) for stature_m in STATURES_M]
    motions = [
        walker(one, _circle(place_m, rng), float(rng.uniform(0, 2 * np.pi)))
        for one, place_m in zip(statures, PLACES_M, strict=True)
    ]
    return poses_at(motions, t_s), np.array(STATURES_M)


def _circle(place_m: tuple[float, float], rng: np.random.Generator) -> FloorPath:
    t_s = np.arange(-1.0, ROUND_S + 2.0, 0.25)
    angle = rng.uniform(0, 2 * np.pi) + rng.choice((-1, 1)) * rng.uniform(0.8, 1.6) * t_s
    around = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    return through(t_s, place_m + CIRCLE_M * around)
