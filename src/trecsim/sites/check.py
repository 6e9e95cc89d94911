"""Check everything that a site file names, before anything runs."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from trecsim import estimators
from trecsim.errors import ConfigError, InputError, SetupError
from trecsim.fusion.arguments import check_arguments
from trecsim.geometry import Rig
from trecsim.sites.estimator_table import EstimatorTable
from trecsim.sites.feed_remarks import feed_remarks
from trecsim.sites.fusion_table import FusionTable, earlier_names, fusion_settings
from trecsim.sites.live_cameras import camera_remarks, clock_remarks, secrets_faults
from trecsim.sites.output_tables import output_remarks
from trecsim.sites.rules import rule_remarks
from trecsim.sites.site_file import OutputTable, PosesPlace, RigPlace, Site, SourceTable
from trecsim.sites.site_reading import Draft, SiteFile, read_draft
from trecsim.skeleton import COCO17
from trecsim.sources import VideoInfo, probe, read_poses
from trecsim.sources.camera_names import unknown_camera
from trecsim.sources.image_sizes import is_cut
from trecsim.toml_models import file_faults
from trecsim.toml_models.toml_reading import Fault


@dataclass(frozen=True, slots=True)
class CheckedSite:
    """A site file without faults, and what was found in the files that it names.

    Attributes
    ----------
    file
        The site file.
    rig
        Its cameras.
    videos
        The properties of its videos, by camera.
    remarks
        Remarks on what is probably wrong but does not prevent a run.
    """

    file: SiteFile
    rig: Rig
    videos: dict[str, VideoInfo]
    remarks: tuple[str, ...]


def check_site(path: Path | str, *, as_live: bool = False) -> CheckedSite:
    """Read a site file and look at everything that it names; all faults are found at once.

    Parameters
    ----------
    path
        The site file.
    as_live
        Whether its recordings will be played as if they were live, and events sent.

    Raises
    ------
    ConfigError
        When anything is wrong; the text lists all faults with their lines.
    SetupError
        When something that is needed to look is not installed.
    """
    draft = read_draft(Path(path))
    remarks: list[str] = []
    faults = list(draft.faults)
    videos: dict[str, VideoInfo] = {}
    rig = _rig(draft, remarks, faults)
    lacking = None
    try:
        faults += _source_faults(draft, rig, videos)
    except SetupError as error:
        lacking = error
    faults += secrets_faults(draft)
    faults += _poses_faults(draft, rig, remarks)
    faults += _estimator_faults(draft)
    faults += _fusion_faults(draft, rig)
    if faults:
        raise file_faults(draft.path, draft.text, faults)
    if lacking is not None:
        raise lacking
    assert draft.site is not None
    assert rig is not None
    site = draft.site
    remarks += _remarks(site, rig, videos)
    remarks += camera_remarks(site)
    remarks += clock_remarks(site, rig, time.time())
    remarks += rule_remarks(site.rules)
    remarks += feed_remarks(site)
    remarks += output_remarks(site.outputs, site.secrets, site.is_live or as_live)
    remarks += earlier_names(draft.data.get("fusion"))
    remarks += [f"fusion: {text}" for text in fusion_settings(site.fusion).remarks()]
    return CheckedSite(SiteFile(draft.path, draft.text, site), rig, videos, tuple(remarks))


def _rig(draft: Draft, remarks: list[str], faults: list[Fault]) -> Rig | None:
    table = draft.part(("rig",), RigPlace)
    if table is None:
        return None
    try:
        rig: Rig = table.read(remarks.append)
    except InputError as error:
        faults.append((("rig",), str(error)))
        return None
    return rig


def _source_faults(draft: Draft, rig: Rig | None, videos: dict[str, VideoInfo]) -> Iterator[Fault]:
    """Yield what is wrong with the videos, also where there is no rig to compare them with."""
    cameras = draft.data.get("sources")
    for camera in cameras if isinstance(cameras, dict) else ():
        key = ("sources", camera)
        if rig is not None and camera not in rig.names:
            yield key, unknown_camera(camera, rig.names, "in the site file")
        source = draft.part(key, SourceTable)
        if source is None or source.video is None:
            continue
        try:
            video = probe(source.video)
        except InputError as error:
            yield (*key, "video"), str(error)
            continue
        if rig is None or camera not in rig.names:
            continue
        videos[camera] = video
        found, expected = video.size_px, rig[camera].size_px
        if found != expected and not is_cut(found, expected):
            yield (*key, "video"), _sizes(found, expected)


def _sizes(found: tuple[int, int], expected: tuple[int, int]) -> str:
    return (
        f"expected images of {expected[0]} x {expected[1]} px, for which the camera is "
        f"calibrated, found {found[0]} x {found[1]} px"
    )


def _poses_faults(draft: Draft, rig: Rig | None, remarks: list[str]) -> Iterator[Fault]:
    table = draft.part(("poses",), PosesPlace)
    if table is None:
        return
    names = rig.names if rig is not None else None
    try:
        images = read_poses(
            table.file,
            rig_cameras=names,
            fps=table.fps,
            names=table.names,
            remark=remarks.append,
        )
        next(images, None)
    except InputError as error:
        yield ("poses",), str(error)


def _estimator_faults(draft: Draft) -> Iterator[Fault]:
    table = draft.part(("estimator",), EstimatorTable)
    if table is None:
        return
    try:
        estimators.check(table.name, **table.settings())
    except InputError as error:
        unknown = table.name.partition(":")[0] not in estimators.names()
        yield ("estimator", *(["name"] if unknown else [])), str(error)


def _fusion_faults(draft: Draft, rig: Rig | None) -> Iterator[Fault]:
    fusion, output = (draft.part((key,), kind) for key, kind in _SETTINGS)
    if rig is None:
        return
    settings = fusion_settings(fusion) if fusion is not None else None
    lag_s = output.lag_s if output is not None else 0.0
    try:
        check_arguments(rig, settings, COCO17, lag_s)
    except ConfigError as error:
        yield ("fusion",), str(error).removeprefix("fusion settings: ")


_SETTINGS = (("fusion", FusionTable), ("output", OutputTable))


def _remarks(site: Site, rig: Rig, videos: dict[str, VideoInfo]) -> Iterator[str]:
    if not site.sources:
        return
    for camera, video in videos.items():
        file = site.sources[camera].video
        text = None if file is None else video.remark(file)
        if text is not None:
            yield text
        if video.size_px != rig[camera].size_px:
            sizes = _sizes(video.size_px, rig[camera].size_px)
            yield f"{camera}: {sizes}; assuming the image was cropped at the right and bottom"
    unused = [name for name in rig.names if name not in site.sources]
    if unused:
        yield f"cameras of the rig without a source: {', '.join(unused)}"
    if len(site.sources) < 2:
        yield "only one camera has a source: people are found where at least two cameras see them"


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
