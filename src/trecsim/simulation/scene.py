"""A scene: cameras, people, a detector, clocks; simulated the same for the same seed."""

from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.simulation.body import Body, bodies
from trecsim.simulation.detector import Detector, Footage, detect
from trecsim.simulation.paths import FloorPath
from trecsim.simulation.room import corner_rig
from trecsim.simulation.walkers import Motion, poses, walker
from trecsim.simulation.wandering import wander
from trecsim.types import Poses2D

TRUTH_HZ = 50.0


@dataclass(frozen=True, slots=True)
class Clock:
    """When a camera takes its images, and what it believes about that.

    Attributes
    ----------
    fps
        Images per second.
    start_s
        Of the first image [s].
    jitter_s
        Standard deviation of the time of an image about its turn [s].
    dropped
        Share of the images that never arrive.
    stamp_error_s
        How far its time stamps are ahead of the truth, beyond what the rig knows [s].
    """

    fps: float = 25.0
    start_s: float = 0.0
    jitter_s: float = 0.0
    dropped: float = 0.0
    stamp_error_s: float = 0.0

    def __post_init__(self) -> None:
        if not (0 < self.fps <= 1000 and 0 <= self.dropped <= 1 and self.jitter_s >= 0):
            raise InputError(
                "a clock needs an fps of at most 1000, a share of dropped images from 0 to 1 and "
                f"no negative jitter, got {self}"
            )

    def times_s(self, seconds: float, rng: np.random.Generator) -> Float64[np.ndarray, " time"]:
        """Return when the images that arrive are taken, increasing [s].

        Parameters
        ----------
        seconds
            Length of the scene [s].
        rng
            Source of chance.
        """
        turns = np.arange(int(np.ceil(max(seconds - self.start_s, 0.0) * self.fps)))
        # Jitter that could exchange two images is cut off.
        jitter = np.clip(self.jitter_s * rng.standard_normal(len(turns)) * self.fps, -0.45, 0.45)
        times_s: Float64[np.ndarray, " time"] = self.start_s + (turns + jitter) / self.fps
        return times_s[rng.uniform(size=len(turns)) >= self.dropped]


@runtime_checkable
class Cast(Protocol):
    """Decides who is in a scene."""

    def __call__(self, seconds: float, rng: np.random.Generator) -> tuple["Person", ...]:
        """Return everybody for a scene of this length [s]."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Person:
    """Somebody in a scene.

    Attributes
    ----------
    stature_m
        Height standing upright [m].
    motion
        Joints at any time.
    """

    stature_m: float
    motion: Motion


@dataclass(frozen=True, slots=True)
class Wanderers:
    """People who wander about a room centred at the origin, come and go.

    Attributes
    ----------
    people
        How many.
    width_m, depth_m
        Floor they use, along x and y [m].
    """

    people: int
    width_m: float
    depth_m: float

    def __call__(self, seconds: float, rng: np.random.Generator) -> tuple[Person, ...]:
        """Return everybody for a scene of this length [s]."""
        paths = wander(self.people, self.width_m, self.depth_m, seconds, rng)
        return _walking(bodies(self.people, rng), paths, rng)


@dataclass(frozen=True, slots=True, eq=False)
class Scripted:
    """People who walk along given paths.

    Attributes
    ----------
    paths
        One per person; see :func:`trecsim.simulation.paths.through`.
    """

    paths: tuple[FloorPath, ...]

    def __call__(self, seconds: float, rng: np.random.Generator) -> tuple[Person, ...]:
        """Return everybody; the paths say when each is there."""
        return _walking(bodies(len(self.paths), rng), self.paths, rng)


def _walking(
    bodies_: tuple[Body, ...], paths: tuple[FloorPath, ...], rng: np.random.Generator
) -> tuple[Person, ...]:
    return tuple(
        Person(body.stature_m, walker(body, path, float(rng.uniform(0, 2 * np.pi))))
        for body, path in zip(bodies_, paths, strict=True)
    )


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """All that is to be simulated.

    Attributes
    ----------
    rig
        The cameras, as the system will know them.
    cast
        Who is there and what they do.
    seconds
        How long [s].
    detector
        How good the 2D pose estimator is.
    clocks
        One per camera in the rig's order, or one for all.
    """

    rig: Rig
    cast: Cast
    seconds: float
    detector: Detector = field(default_factory=Detector)
    clocks: tuple[Clock, ...] = (Clock(),)

    def __post_init__(self) -> None:
        if len(self.clocks) not in (1, len(self.rig)):
            raise InputError(
                f"a scene needs one clock, or one per camera: {len(self.rig)} cameras, "
                f"{len(self.clocks)} clocks"
            )
        if not 0 < self.seconds < np.inf:
            raise InputError(f"a scene needs a positive length, got {self.seconds:g} s")


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """What a simulated scene gives.

    Attributes
    ----------
    rig
        The cameras.
    poses
        What the estimator reports, in order of arrival.
    truth_t_s
        Times at which the truth is known [s].
    truth_xyz_m
        Joints of everybody then, NaN while absent [m].
    """

    rig: Rig
    poses: tuple[Poses2D, ...]
    truth_t_s: Float64[np.ndarray, " time"]
    truth_xyz_m: Float64[np.ndarray, "person time 17 3"]


def simulate(scene: Scene, seed: int) -> Simulation:
    """Return what the cameras report of a scene, and the truth.

    Parameters
    ----------
    scene
        All that is to be simulated.
    seed
        The same seed gives the same simulation. People do not depend on the cameras, nor one
        camera on the others.

    Examples
    --------
    >>> made = simulate(room_scene(people=1, seconds=2.0), seed=0)
    >>> len(made.poses), made.truth_xyz_m.shape
    (200, (1, 101, 17, 3))
    """
    of_people, of_cameras = np.random.SeedSequence(seed).spawn(2)
    people = scene.cast(scene.seconds, np.random.default_rng(of_people))
    clocks = scene.clocks if len(scene.clocks) > 1 else scene.clocks * len(scene.rig)
    images: list[tuple[float, int, Poses2D]] = []
    seeds = of_cameras.spawn(len(scene.rig))
    for number, (camera, clock, own) in enumerate(zip(scene.rig, clocks, seeds, strict=True)):
        taken_s, seen = _look(scene, camera, clock, people, np.random.default_rng(own))
        images.extend(zip(taken_s, [number] * len(seen), seen, strict=True))
    images.sort(key=lambda image: image[:2])
    truth_t_s = np.arange(int(np.floor(scene.seconds * TRUTH_HZ)) + 1) / TRUTH_HZ
    truth_xyz_m = poses([person.motion for person in people], truth_t_s)
    return Simulation(scene.rig, tuple(image[2] for image in images), truth_t_s, truth_xyz_m)


def _look(
    scene: Scene,
    camera: Camera,
    clock: Clock,
    people: tuple[Person, ...],
    rng: np.random.Generator,
) -> tuple[list[float], list[Poses2D]]:
    """Return when one camera takes its images, and what is found in them."""
    taken_s = clock.times_s(scene.seconds, rng)
    footage = Footage(
        camera=camera,
        taken_s=taken_s,
        stamp_s=taken_s - camera.time_offset_s + clock.stamp_error_s,
        xyz_m=poses([person.motion for person in people], taken_s),
        stature_m=np.array([person.stature_m for person in people]),
    )
    return [float(t_s) for t_s in taken_s], detect(footage, scene.detector, rng)


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

    The cameras run freely: each takes its images at its own moment.

    Parameters
    ----------
    people, cameras
        How many.
    seconds
        How long [s].
    width_m, depth_m, height_m
        The room, and the height of the cameras [m].
    fps
        Images per second of each camera.
    """
    rig = corner_rig(width_m, depth_m, height_m, cameras)
    clocks = tuple(Clock(fps, start_s=(0.37 * number % 1.0) / fps) for number in range(cameras))
    cast = Wanderers(people, 0.8 * width_m, 0.8 * depth_m)
    return Scene(rig, cast, seconds, clocks=clocks)
