"""The sources of a site that runs live: cameras, and recordings played as if they were live."""

from collections.abc import Sequence

from trecsim.errors import ConfigError
from trecsim.estimators import Estimator2D, image_limit_px
from trecsim.sites.check import CheckedSite
from trecsim.sites.live_cameras import address_of, login_faults
from trecsim.sources import VideoFile, read_poses
from trecsim.sources.streams import Pace, PosesStream, RecordedStream, StreamSource
from trecsim.toml_models import file_faults


def image_sources(
    checked: CheckedSite, estimator: Estimator2D
) -> Sequence[StreamSource | RecordedStream]:
    """Return the cameras of a site; its recordings are played as if they were live.

    Parameters
    ----------
    checked
        What `trecsim.sites.check.check_site` returns.
    estimator
        Images come no larger than it looks at them.

    Raises
    ------
    ConfigError
        When credentials cannot be found; with their lines.
    """
    file, limit_px = checked.file, image_limit_px(estimator)
    faults = list(login_faults(file.site))
    if faults:
        raise file_faults(file.path, file.text, faults)
    pace = Pace(min((video.start_s for video in checked.videos.values()), default=0.0))
    sources: list[StreamSource | RecordedStream] = []
    for camera, source in file.site.sources.items():
        if source.video is not None:
            video = VideoFile(
                source.video, camera, decode_size_px=limit_px, threads=1, mask_px=source.mask_px
            )
            sources.append(RecordedStream(video, pace))
        else:
            address = address_of(file.site, source)
            size_px = checked.rig[camera].size_px
            sources.append(StreamSource(camera, address, size_px, limit_px, source.mask_px))
    return sources


def poses_source(checked: CheckedSite) -> PosesStream:
    """Return the 2D poses of a site, played as if they were live.

    Parameters
    ----------
    checked
        What `trecsim.sites.check.check_site` returns, of a site with `poses`.

    Raises
    ------
    ConfigError
        When the site has no poses.
    InputError
        When they cannot be read.
    """
    table = checked.file.site.poses
    if table is None:
        raise ConfigError(f"{checked.file.path}: expected a site with poses, found cameras")
    names = checked.rig.names
    poses = read_poses(
        table.file, rig_cameras=names, fps=table.fps, names=table.names, remark=_said_before
    )
    return PosesStream(poses, names)


def _said_before(remark: str) -> None:
    """Drop a remark that `check_site` has returned."""
