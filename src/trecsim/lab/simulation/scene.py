"""Synthetic scenes: cameras, people, detector and clocks; deterministic for a given seed."""

from copy import deepcopy
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float64

from trecsim.callbacks import Progress
from trecsim.errors import InputError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.lab.simulation.camera_clocks import Clock
from trecsim.lab.simulation.detector import Footage, detect
from trecsim.lab.simulation.detector_errors import Detector
from trecsim.lab.simulation.failures import Knock, Outage
from trecsim.lab.simulation.occlusion import Obstacle
from trecsim.lab.simulation.people import PathWalkers, People, Person, Wanderers
from trecsim.lab.simulation.room import corner_rig
from trecsim.lab.simulation.walkers import poses
from trecsim.values import Poses2D

__all__ = [
    "Clock",
    "PathWalkers",
    "People",
    "Person",
    "Scene",
    "Simulation",
    "Wanderers",
    "room_scene",
    "simulate",
]

TRUTH_HZ = 50.0
LONGEST_S = 24 * 3600.0
MOST_SIGHTS = 4_000_000
"""Largest number of images times people; they are held in memory, a few GB."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Description of a synthetic scene.

    Attributes
    ----------
    rig
        The cameras as the tracker will know them.
    people
        The people and their motion.
    seconds
        Length [s].
    detector
        Errors of the 2D pose estimator.
    clocks
        One per camera in the rig's order, or one for all.
    obstacles
        Boxes that occlude people.
    outages
        Cameras that stop delivering images.
    knocks
        Cameras that are moved while the rig stays as it was; a move at 0 s is an error of the
        calibration (see `trecsim.lab.simulation.failures.turned`).
    name, about
        Name, and a description in one line.
    seed
        Default seed.
    """

    rig: Rig
    people: People
    seconds: float
    detector: Detector = field(default_factory=Detector)
    clocks: tuple[Clock, ...] = (Clock(),)
    obstacles: tuple[Obstacle, ...] = ()
    outages: tuple[Outage, ...] = ()
    knocks: tuple[Knock, ...] = ()
    name: str = ""
    about: str = ""
    seed: int = 0

    def __post_init__(self) -> None:
        if len(self.clocks) not in (1, len(self.rig)):
            raise InputError(
                f"a scene needs one clock, or one per camera: {len(self.rig)} cameras, "
                f"{len(self.clocks)} clocks"
            )
        if not 0 < self.seconds <= LONGEST_S:
            raise InputError(
                f"a scene needs a positive length of at most {LONGEST_S:g} s, "
                f"got {self.seconds:g} s"
            )
        knocked = [knock.camera for knock in self.knocks]
        for name in (*knocked, *(outage.camera for outage in self.outages)):
            self.rig.index(name)


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """Synthetic 2D poses and their ground truth.

    Attributes
    ----------
    rig
        The cameras.
    poses
        2D poses in order of arrival.
    truth_t_s
        Times of the ground truth [s].
    truth_xyz_m
        Joints of all people, NaN while absent [m].
    """

    rig: Rig
    poses: tuple[Poses2D, ...]
    truth_t_s: Float64[np.ndarray, " time"]
    truth_xyz_m: Float64[np.ndarray, "person time 17 3"]


def simulate(scene: Scene, seed: int | None = None, progress: Progress | None = None) -> Simulation:
    """Return synthetic 2D poses of a scene, and the ground truth.

    Parameters
    ----------
    scene
        The scene.
    seed
        The same seed gives the same result; None takes that of the scene. People do not depend on
        the cameras, cameras not on each other, and images not on failures.
    progress
        Called with the number of finished cameras, and of all.

    Raises
    ------
    InputError
        The scene is too large for the memory, or the seed is negative.

    Examples
    --------
    >>> made = simulate(room_scene(people=1, seconds=2.0), seed=0)
    >>> len(made.poses), made.truth_xyz_m.shape
    (200, (1, 101, 17, 3))
    """
    seed = scene.seed if seed is None else seed
    if seed < 0:
        raise InputError(f"a seed is a whole number from 0, got {seed}")
    of_people, of_cameras, of_habits = np.random.SeedSequence(seed).spawn(3)
    common_seed = int(of_habits.generate_state(1, np.uint64)[0])
    clocks = scene.clocks if len(scene.clocks) > 1 else scene.clocks * len(scene.rig)
    _check_size(scene, clocks)
    people = scene.people(scene.seconds, np.random.default_rng(of_people))
    images: list[tuple[float, int, Poses2D]] = []
    seeds = of_cameras.spawn(len(scene.rig))
    for number, (camera, clock, own) in enumerate(zip(scene.rig, clocks, seeds, strict=True)):
        taken_s, seen = _look(scene, camera, clock, people, np.random.default_rng(own), common_seed)
        images.extend(zip(taken_s, [number] * len(seen), seen, strict=True))
        if progress is not None:
            progress(number + 1, len(scene.rig))
    images.sort(key=lambda image: image[:2])
    truth_t_s = np.arange(int(np.floor(scene.seconds * TRUTH_HZ)) + 1) / TRUTH_HZ
    truth_xyz_m = poses([person.motion for person in people], truth_t_s)
    return Simulation(scene.rig, tuple(image[2] for image in images), truth_t_s, truth_xyz_m)


def _check_size(scene: Scene, clocks: tuple[Clock, ...]) -> None:
    people = scene.people.count
    images = sum(max(scene.seconds - clock.start_s, 0.0) * clock.fps for clock in clocks)
    sights = max(images, scene.seconds * TRUTH_HZ) * (people + 1)
    if sights > MOST_SIGHTS:
        raise InputError(
            f"{images:.0f} images and {people} people are too many for one simulation: images "
            f"times people may reach {MOST_SIGHTS}; make the scene shorter, or split it"
        )


def _look(
    scene: Scene,
    camera: Camera,
    clock: Clock,
    people: tuple[Person, ...],
    rng: np.random.Generator,
    common_seed: int,
) -> tuple[list[float], list[Poses2D]]:
    """Return the times of one camera's images, and the poses in them."""
    taken_s, stamp_s = clock.ticks(scene.seconds, rng)
    footage = Footage(
        camera=camera,
        taken_s=taken_s,
        stamp_s=camera.stamp_s(stamp_s),
        xyz_m=poses([person.motion for person in people], taken_s),
        stature_m=np.array([person.stature_m for person in people]),
        obstacles=scene.obstacles,
        common_seed=common_seed,
    )
    seen: list[Poses2D] = []
    for view, until_s in _views(scene, camera):
        until = int(np.searchsorted(taken_s, until_s))
        if until > len(seen):
            # The same random numbers, so that only the view differs.
            found = detect(replace(footage, camera=view), scene.detector, deepcopy(rng))
            seen += found[len(seen) : until]
    silent = np.zeros(len(taken_s), dtype=bool)
    for outage in scene.outages:
        if outage.camera == camera.name:
            silent |= outage.silent(taken_s)
    kept = np.flatnonzero(~silent)
    return [float(taken_s[i]) for i in kept], [seen[i] for i in kept]


def _views(scene: Scene, camera: Camera) -> list[tuple[Camera, float]]:
    """Return one camera as it truly stands, between its moves, and until when [s]."""
    knocks = [knock for knock in scene.knocks if knock.camera == camera.name]
    views = [(camera, np.inf)]
    for knock in sorted(knocks, key=lambda knock: knock.t_s):
        before, _ = views[-1]
        views[-1:] = [(before, knock.t_s), (knock.moved(before), np.inf)]
    return views


def room_scene(
    *,
    people: int = 4,
    cameras: int = 4,
    seconds: float = 20.0,
    width_m: float = 8.0,
    depth_m: float = 6.0,
    height_m: float = 2.7,
    fps: float = 25.0,
) -> Scene:
    """Return a room with cameras in its corners and people who wander about.

    The cameras are not synchronised.

    Parameters
    ----------
    people, cameras
        Number of each.
    seconds
        Length [s].
    width_m, depth_m, height_m
        Size of the room, and height of the cameras [m].
    fps
        Images per second of each camera.
    """
    rig = corner_rig(width_m, depth_m, height_m, cameras)
    clocks = tuple(Clock(fps, start_s=(0.37 * number % 1.0) / fps) for number in range(cameras))
    wanderers = Wanderers(people, 0.8 * width_m, 0.8 * depth_m)
    return Scene(rig, wanderers, seconds, clocks=clocks)
