"""Check everything that a site file names, before anything runs."""

from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from trecsim import estimators
from trecsim.errors import ConfigError, InputError
from trecsim.fusion.arguments import check_arguments
from trecsim.geometry import Rig
from trecsim.sites.site_file import Site, fusion_settings
from trecsim.sites.site_reading import SiteFile, read_site
from trecsim.skeleton import COCO17
from trecsim.sources import VideoInfo, probe, read_poses
from trecsim.toml_models import file_faults
from trecsim.toml_models.lines import KeyPath

Fault = tuple[KeyPath, str]


@dataclass(frozen=True, slots=True)
class CheckedSite:
    """A site file of which everything was found to be there.

    Attributes
    ----------
    file
        The site file.
    rig
        Its cameras.
    videos
        What its videos say of themselves, by camera.
    remarks
        What is doubtful without being wrong.
    """

    file: SiteFile
    rig: Rig
    videos: dict[str, VideoInfo]
    remarks: tuple[str, ...]


def check_site(path: Path | str) -> CheckedSite:
    """Read a site file and look at everything that it names.

    Parameters
    ----------
    path
        The site file.

    Raises
    ------
    ConfigError
        When anything is wrong; the text lists all faults with their lines.
    SetupError
        When something that is needed to look is not installed.
    """
    path = Path(path)
    file = read_site(path)
    remarks: list[str] = []
    faults: list[Fault] = []
    try:
        rig = file.site.rig.read(remarks.append)
    except InputError as error:
        raise file_faults(path, file.text, [(("rig",), str(error))]) from None
    videos: dict[str, VideoInfo] = {}
    faults += _source_faults(file.site, rig, videos)
    faults += _poses_faults(file.site, rig)
    faults += _estimator_faults(file.site)
    faults += _fusion_faults(file.site, rig)
    if faults:
        raise file_faults(path, file.text, faults)
    remarks += _remarks(file.site, rig, videos)
    remarks += [f"fusion: {text}" for text in fusion_settings(file.site.fusion).remarks()]
    return CheckedSite(file, rig, videos, tuple(remarks))


def _source_faults(site: Site, rig: Rig, videos: dict[str, VideoInfo]) -> Iterator[Fault]:
    for camera, source in site.sources.items():
        key = ("sources", camera)
        if camera not in rig.names:
            near = get_close_matches(camera, rig.names, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"it has {', '.join(rig.names)}"
            yield key, f"there is no such camera in the rig; {hint}"
            continue
        try:
            videos[camera] = probe(source.video)
        except InputError as error:
            yield (*key, "video"), str(error)
            continue
        found, expected = videos[camera].size_px, rig[camera].size_px
        if found != expected and not _is_cut(found, expected):
            yield (*key, "video"), _sizes(found, expected)


def _is_cut(found: tuple[int, int], expected: tuple[int, int]) -> bool:
    """Tell whether images only lack a few rows or columns, as encoders and editors leave them."""
    return all(0.98 * e <= f <= e for f, e in zip(found, expected, strict=True))


def _sizes(found: tuple[int, int], expected: tuple[int, int]) -> str:
    return (
        f"expected images of {expected[0]} x {expected[1]} px, for which the camera is "
        f"calibrated, found {found[0]} x {found[1]} px"
    )


def _poses_faults(site: Site, rig: Rig) -> Iterator[Fault]:
    if site.poses is None:
        return
    try:
        poses = read_poses(site.poses.file, rig_cameras=rig.names, fps=site.poses.fps)
        next(poses, None)
    except InputError as error:
        yield ("poses",), str(error)


def _estimator_faults(site: Site) -> Iterator[Fault]:
    name = site.estimator.name.partition(":")[0]
    if site.sources and name not in estimators.names():
        near = get_close_matches(name, estimators.names(), n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        known = ", ".join(estimators.names())
        yield ("estimator", "name"), f"{name!r} is not installed; known: {known}{hint}"


def _fusion_faults(site: Site, rig: Rig) -> Iterator[Fault]:
    try:
        check_arguments(rig, fusion_settings(site.fusion), COCO17, site.output.lag_s)
    except ConfigError as error:
        yield ("fusion",), str(error).removeprefix("fusion settings: ")


def _remarks(site: Site, rig: Rig, videos: dict[str, VideoInfo]) -> Iterator[str]:
    if not site.sources:
        return
    for camera, video in videos.items():
        if video.size_px != rig[camera].size_px:
            sizes = _sizes(video.size_px, rig[camera].size_px)
            yield f"{camera}: {sizes}; taken as cut off at the right and at the bottom"
    unused = [name for name in rig.names if name not in site.sources]
    if unused:
        yield f"cameras of the rig without a source: {', '.join(unused)}"
    if len(site.sources) < 2:
        yield "one camera alone sees no depth: people are found where two or more see them"


def load_estimator(file: SiteFile) -> estimators.Estimator2D:
    """Return the estimator of a site, ready to work; a model it lacks is fetched.

    Raises
    ------
    ConfigError
        When a setting is wrong; with the line of the table.
    SetupError
        When something it needs is not installed or not here.
    """
    table = file.site.estimator
    try:
        return estimators.load(table.name, **table.settings())
    except ConfigError as error:
        raise file_faults(file.path, file.text, [(("estimator",), str(error))]) from None
