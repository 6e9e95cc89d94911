"""The sample recording: real video of four cameras, its 2D poses kept on disk, its actors in 2D.

Its two scenes show the same man; in one of them a woman stands in front of him. There is no 3D
truth: what a camera shows that was not used is what everything is judged by.
"""

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

from harness.actors_2d import Labels, followed_in_2d
from trecsim.calibration import read_rig
from trecsim.geometry import Rig
from trecsim.sources import read_poses
from trecsim.values import Poses2D

FPS = 60.0
SCENES = ("SinglePerson", "MultiPerson")
CAMERAS = ("cam01", "cam02", "cam03", "cam04")

# Where the middle of everybody is in the first image of each camera [px], told by eye.
_MAN = {"cam01": (455, 615), "cam02": (564, 639), "cam03": (602, 775), "cam04": (312, 836)}
_WOMAN = {"cam01": (798, 1190), "cam02": (199, 976), "cam03": (269, 718), "cam04": (740, 626)}
_BYSTANDER = {"cam01": (75, 435), "cam02": (797, 600)}
FIRST_PX = {
    "SinglePerson": {"man": _MAN, "bystander": _BYSTANDER},
    "MultiPerson": {"man": _MAN, "woman": _WOMAN, "bystander": _BYSTANDER},
}
ACTORS = {"SinglePerson": ("man",), "MultiPerson": ("man", "woman")}


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """One scene: cameras, 2D poses, and whose they are.

    Attributes
    ----------
    name
        Of the scene.
    rig
        Its cameras as delivered.
    images
        By camera and frame.
    labels
        By camera, the key points of each actor in each frame.
    digest
        Of its videos.
    """

    name: str
    rig: Rig
    images: dict[str, list[Poses2D]]
    labels: dict[str, Labels]
    digest: str

    @property
    def actors(self) -> tuple[str, ...]:
        """Who is to be followed."""
        return ACTORS[self.name]

    def of(self, cameras: tuple[str, ...]) -> tuple[Rig, list[Poses2D]]:
        """Return some of the cameras, and their images in order of time."""
        rig = Rig(tuple(camera for camera in self.rig if camera.name in cameras))
        frames = zip(*(self.images[name] for name in rig.names), strict=True)
        return rig, [image for frame in frames for image in frame]


def frame_of(t_s: float) -> int:
    """Return the number of the frame that was taken at a time."""
    return round(t_s * FPS)


def recorded(folder: Path, scene: str) -> Recorded:
    """Read a scene of the sample recording; its 2D poses are estimated once."""
    rig = read_rig(folder / scene / "Calib.qca.txt")
    images: dict[str, list[Poses2D]] = {name: [] for name in rig.names}
    path, digest = poses_file(folder / scene, rig)
    for image in read_poses(path):
        images[image.camera].append(image)
    first_px = FIRST_PX[scene]
    labels = {
        name: followed_in_2d(
            images[name],
            {who: places[name] for who, places in first_px.items() if name in places},
        )
        for name in rig.names
    }
    return Recorded(scene, rig, images, labels, digest)


def poses_file(scene: Path, rig: Rig) -> tuple[Path, str]:
    """Return the file of a scene's 2D poses, estimated where there is none yet, and the digest.

    The file's name holds a digest of the videos, so that other videos get other poses.
    """
    from trecsim.estimators.pool import estimate
    from trecsim.store.poses_writer import PosesWriter

    videos = sorted((scene / "videos").glob("*.mp4"))
    whole = hashlib.sha256()
    for video in videos:
        whole.update(video.read_bytes())
    digest = whole.hexdigest()[:12]
    path = cache_folder() / f"{scene.name}-movenet-{digest}.poses.jsonl"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        with PosesWriter(path) as writer:
            for image in estimate(dict(zip(sorted(rig.names), videos, strict=True))):
                writer.write(image)
    return path, digest


def cache_folder() -> Path:
    """Return where what takes long to make is kept: ``TRECSIM_BENCHMARK_CACHE`` or the user's."""
    given = os.environ.get("TRECSIM_BENCHMARK_CACHE")
    users = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return Path(given) if given else users / "trecsim-benchmarks"
