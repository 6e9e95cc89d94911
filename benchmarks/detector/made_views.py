"""Made people before the cameras of Shelf, in all cameras, as a simulated detector finds them."""

import numpy as np

from detector import openpose_on_shelf as on_shelf
from detector.key_points import LIMBS
from detector.stated_noise import Views, paired
from trecsim.geometry import Rig
from trecsim.lab.simulation.detector import Footage, detect
from trecsim.lab.simulation.detector_errors import Detector

FRAMES = 300


def made(detector: Detector, seed: int) -> tuple[Rig, list[Views]]:
    """Return the cameras, and everybody in them; the same seed gives the same."""
    source = np.random.SeedSequence(seed)
    of_people, *of_cameras = source.spawn(1 + len(on_shelf.STANDS_M))
    t_s = np.arange(FRAMES) / on_shelf.FPS
    xyz_m, stature_m = on_shelf.people(t_s, np.random.default_rng(of_people))
    rig = Rig(tuple(on_shelf.camera(number) for number in range(len(of_cameras))))
    shape = (len(rig), FRAMES, 17)
    people = [Views(np.full((*shape, 2), np.nan), np.zeros(shape)) for _ in range(len(xyz_m))]
    common_seed = int(source.generate_state(1, np.uint64)[0])
    for number, (camera, own) in enumerate(zip(rig, of_cameras, strict=True)):
        footage = Footage(camera, t_s, t_s, xyz_m, stature_m, (), common_seed)
        for frame, poses in enumerate(detect(footage, detector, np.random.default_rng(own))):
            for person, detection in paired(camera.project(xyz_m[:, frame, LIMBS]), poses):
                people[person].xy_px[number, frame] = poses.xy_px[detection]
                people[person].score[number, frame] = poses.score[detection]
    return rig, people
