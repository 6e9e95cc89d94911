"""The live cameras of a site: what is wrong with what the file says of them, and their sources."""

from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.redaction import redacted
from trecsim.sites.site_file import Site, SourceTable
from trecsim.sites.site_reading import Draft
from trecsim.sources.streams.camera_login import find_login, read_secrets
from trecsim.sources.streams.stream_address import Address, DeviceAddress, NetworkAddress
from trecsim.sync.stream_time import AHEAD_S
from trecsim.toml_models import FilePath
from trecsim.toml_models.toml_reading import Fault


def secrets_faults(draft: Draft) -> Iterator[Fault]:
    """Yield what is wrong with the file of secrets; where there is none, `camera_remarks` tells."""
    path: Path | None = draft.part(("secrets",), FilePath)
    if path is None or not path.exists():
        return
    try:
        read_secrets(path)
    except InputError as error:
        yield ("secrets",), str(error)


def camera_remarks(site: Site) -> Iterator[str]:
    """Yield what a site lacks to run here and now, and what is probably a slip."""
    yield from (text for _, text in login_faults(site))
    places: dict[str, list[str]] = defaultdict(list)
    for camera, source in site.sources.items():
        if source.device is not None and not Path(source.device).exists():
            yield f"{camera}: there is no camera {source.device} at this machine now"
        if source.is_live:
            places[str(source.url or source.device)].append(camera)
    for place, cameras in places.items():
        if len(cameras) > 1:
            yield f"{' and '.join(cameras)} show the same stream: {redacted(place)}"
    if site.is_live and site.output.poses:
        yield (
            "output.poses: 2D poses of a live site are kept without a limit: poses.jsonl grows as "
            "long as the run lasts, whatever [retention] says; leave it out unless you need them"
        )


def clock_remarks(site: Site, rig: Rig, now_s: float) -> Iterator[str]:
    """Yield which live cameras the rig gives the clocks of the recordings it was made from.

    A calibration finds when each recording was started, and how its clock drifts. Live cameras are
    dated by clocks of their own: shifted so far, their images are never combined.

    Parameters
    ----------
    site
        The site.
    rig
        Its cameras.
    now_s
        The present, Unix time [s].
    """
    live = [name for name, source in site.sources.items() if source.is_live and name in rig.names]
    off_s = {name: rig[name].time_s(now_s) - now_s for name in live}
    told = [f"{name} ({off:+.3g} s)" for name, off in off_s.items() if abs(off) > AHEAD_S]
    if told:
        yield (
            f"{site.rig.file} shifts the times of live cameras by more than {AHEAD_S:g} s, as for "
            f"recordings that were started by hand: {', '.join(told)}. Live cameras have clocks of "
            "their own, and images shifted so far are not combined with those of other cameras: "
            "delete time_offset_s, time_drift_ppm and time_ref_s there"
        )


def login_faults(site: Site) -> Iterator[Fault]:
    """Yield which credentials of cameras cannot be found."""
    for camera, source in site.sources.items():
        if source.credentials is None:
            continue
        try:
            find_login(source.credentials, site.secrets)
        except InputError as error:
            yield ("sources", camera, "credentials"), f"{camera}: {error}"


def address_of(site: Site, source: SourceTable) -> Address:
    """Return where a live camera is, with user and password.

    Raises
    ------
    ConfigError
        When its credentials cannot be found.
    """
    if source.device is not None:
        return DeviceAddress(source.device)
    assert source.url is not None
    name = source.credentials
    login = find_login(name, site.secrets) if name is not None else None
    return NetworkAddress(source.url, source.transport, login, name)
