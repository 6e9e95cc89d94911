"""A real recording to try things on: the demo that comes with Pose2Sim.

Two scenes of 100 frames by the same four synchronised cameras: a man on a treadmill, alone and
with a rendered woman near the cameras. Fetched from the pinned release; nothing of it is in
trecsim itself.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from trecsim.calibration import read_rig, write_rig
from trecsim.errors import InputError
from trecsim.estimators.download import Member, Package, fetch, matches
from trecsim.geometry import Rig
from trecsim.sources import probe
from trecsim.store.atomic import atomic_write
from trecsim.store.names import RIG

PACKAGE = Package("pose2sim", "0.10.49")
NOTICE = (
    "The recording is part of Pose2Sim, copyright (c) 2022, perfanalytics, under the BSD 3-Clause "
    "licence: see LICENSE.txt beside it"
)
CAMERAS = ("cam01", "cam02", "cam03", "cam04")

_LICENCE = Member(
    ("pose2sim-0.10.49.dist-info/licenses/LICENSE",),
    "7f8a9ede713463b96d261a39c3ec404748c8e4f528c795e5f8cb18898ed944cf",
    1521,
)
_CALIBRATION = ("fd90e4bbae3278ef1dc0cdd42a34ee06bf88286f628a02c00a29407aa39e34c5", 4843)
_VIDEOS = {
    "MultiPerson": (
        ("543cee6a4c2c2b52dc9eac9137ee63d14f1f84e706a9a7264769edcb11e5ea53", 764061),
        ("8895092a7cf26359205a427b7ac2f4a935c2e0bd36d9b7a5140cb33faa468a6b", 610385),
        ("d3daf48cdf9f5603868ddb99166ddaf9b12279e7ce968922926560d5fd3f0c99", 801091),
        ("1490149dc40e7301fa5ceae23862b044ba5c398a8b2a40df21ed894702728c09", 877130),
    ),
    "SinglePerson": (
        ("cf4f2816c86bea4bfbea255333d8626ff32a3ecabdab8b0fb147cea9167fde3a", 387775),
        ("94ff87cf978b8406e8aa36ab3c5362e72848994e87652f0dc7a33c315e8e0442", 540548),
        ("b8b329f832f178f27ecb78d024d5026b96c6adb36c387bfe2c0af85eab8a11ca", 1709101),
        ("b5c0e7863fd70d008e7178d3c556b045b0ea5f78fcd61ca548a0b2e807e641f7", 1772999),
    ),
}


def fetch_sample(
    folder: Path, *, progress: Callable[[int, int | None], None] | None = None
) -> list[Path]:
    """Put the recording into `folder`, ready to run, and return its site files.

    Existing files are kept: complete videos, and rig and site files even if they were changed.

    Parameters
    ----------
    folder
        Gets one folder per scene; made if it is not there.
    progress
        Called with the bytes that have arrived and, once known, how many there are.

    Raises
    ------
    InputError
        When `folder` is a file.
    SetupError
        When the recording cannot be fetched; the text says what to put where by hand.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; give the name of a directory")
    wanted = files(folder)
    missing = {path: member for path, member in wanted.items() if not matches(path, member)}
    if missing:
        fetch(PACKAGE, missing, progress=progress)
    return [_make_ready(folder / scene) for scene in _VIDEOS]


def files(folder: Path) -> dict[Path, Member]:
    """Return what belongs where under `folder`."""
    return {folder / "LICENSE.txt": _LICENCE, **dict(_scene_files(folder))}


def _scene_files(folder: Path) -> Iterator[tuple[Path, Member]]:
    for scene, videos in _VIDEOS.items():
        inside = f"Pose2Sim/Demo_{scene}"
        calibration = f"{inside}/calibration/Calib.qca.txt"
        yield folder / scene / "Calib.qca.txt", Member((calibration,), *_CALIBRATION)
        for camera, (sha256, size_bytes) in zip(CAMERAS, videos, strict=True):
            video = f"videos/{camera}.mp4"
            yield folder / scene / video, Member((f"{inside}/{video}",), sha256, size_bytes)


def _make_ready(scene: Path) -> Path:
    site, rig = scene / "site.toml", scene / RIG
    if not rig.exists():
        write_rig(_rig_of_videos(scene), rig)
    if not site.exists():
        with atomic_write(site) as file:
            file.write(_site(scene.name))
    return site


def _rig_of_videos(scene: Path) -> Rig:
    """Return the calibration with the sizes of the videos.

    Two videos of one scene were cut by eight columns on the right after the calibration, which
    moves nothing.
    """
    rig = read_rig(scene / "Calib.qca.txt")
    sizes = {name: probe(scene / "videos" / f"{name}.mp4").size_px for name in rig.names}
    return Rig(tuple(replace(camera, size_px=sizes[camera.name]) for camera in rig))


def _site(scene: str) -> str:
    lines = [
        f"# Pose2Sim's demo recording, scene {scene}. Run it: trecsim run site.toml",
        'format = "trecsim.site/1"',
        f'name = "pose2sim-{scene.removesuffix("Person").lower()}"',
        f'rig = "{RIG}"',
    ]
    for camera in CAMERAS:
        lines += ["", f"[sources.{camera}]", f'video = "videos/{camera}.mp4"']
    return "\n".join([*lines, "", "[estimator]", 'name = "movenet"', ""])
