"""What a site lacks to run live: each camera is looked at, the page, and the disk."""

import shutil
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from threading import Thread

from trecsim.doctor import Finding
from trecsim.errors import Error, InputError
from trecsim.outputs.mqtt import broker_answer
from trecsim.outputs.output_checks import LOOK_S as ANSWER_S
from trecsim.outputs.output_checks import look_at
from trecsim.page.address import PageAddress
from trecsim.page.site_address import page_address
from trecsim.sites.check import CheckedSite
from trecsim.sites.feed_brokers import VERSION, broker_of
from trecsim.sites.feed_tables import FeedTable
from trecsim.sites.live_cameras import address_of, login_faults
from trecsim.sites.output_tables import DeliveryTable
from trecsim.sites.site_file import Site
from trecsim.sources.streams import StreamSource

LOOK_S = 10.0  # each camera is looked at for so long, all at the same time,
ENOUGH = 60  # or for so many images, once its clock is known
SLOWEST_FPS = 5.0  # people who walk move too far from one image to the next below
_RATES = "10 to 15 images per second are enough, fewer than 5 lose people who walk"
_LEAST_FREE_BYTES = 10 * 10**9  # some days with 20 people


def examine_site(checked: CheckedSite, look_s: float = LOOK_S) -> Iterator[Finding]:
    """Look at everything that a site needs to run live; never raises.

    Parameters
    ----------
    checked
        What `trecsim.sites.check.check_site` returns.
    look_s
        How long to look at the cameras [s].
    """
    site = checked.file.site
    for camera, text in _without_login(checked).items():
        yield Finding(f"camera {camera}", "broken", "not looked at", text, essential=True)
    watches = [_Watch(source) for source in _sources(checked)]
    end_s = time.monotonic() + look_s
    while time.monotonic() < end_s and not all(watch.has_seen_enough for watch in watches):
        time.sleep(0.05)
    for watch in watches:
        watch.source.close()
    for watch in watches:
        yield from watch.findings()
    if site.page is not None:
        yield _port(site.page.host, site.page.port)
        yield _access(page_address(site.page))
    for output in site.outputs:
        yield _output(output, site)
    for name, feed in site.feeds.items():
        if feed.mqtt is not None:
            yield _broker(name, feed, site)
    yield _disk(site.output.directory or checked.file.path.parent)


def _without_login(checked: CheckedSite) -> dict[str, str]:
    return {str(key[1]): text for key, text in login_faults(checked.file.site)}


def _sources(checked: CheckedSite) -> list[StreamSource]:
    site, missing = checked.file.site, _without_login(checked)
    return [
        StreamSource(camera, address_of(site, source), checked.rig[camera].size_px)
        for camera, source in site.sources.items()
        if source.is_live and camera not in missing
    ]


class _Watch:
    """Watches one camera in a thread."""

    def __init__(self, source: StreamSource) -> None:
        self.source = source
        self._came_s: list[float] = []
        self._late_s: list[float] = []
        Thread(target=self._look, name=f"doctor-{source.camera}", daemon=True).start()

    @property
    def has_seen_enough(self) -> bool:
        return len(self._came_s) >= ENOUGH and self.source.counters.clock == "sender"

    def _look(self) -> None:
        for frame in self.source:
            self._came_s.append(time.monotonic())
            self._late_s.append(time.time() - frame.t_s)

    def findings(self) -> Iterator[Finding]:
        """Yield what was seen of the camera, and of its clock."""
        name, counters = f"camera {self.source.camera}", self.source.counters
        if not self._came_s:
            fault = counters.fault or "no image came"
            text, _, remedy = fault.partition("; ")
            remedy = remedy or "look at it with another program, as VLC; then at its network"
            yield Finding(name, "broken", text, remedy, essential=True)
            return
        width, height = counters.size_px or (0, 0)
        fps = self._fps()
        text = f"{counters.codec}, {width} x {height} px, {fps:.1f} images/s"
        lost = counters.dropped.get("decode", 0)
        if lost:
            text += f", {lost} could not be decoded"
        slow = fps < SLOWEST_FPS and len(self._came_s) > 1
        yield Finding(name, "broken" if slow else "ok", text, f"set its rate: {_RATES}" * slow)
        yield self._clock()

    def _fps(self) -> float:
        steps = len(self._came_s) - 1
        return steps / max(1e-9, self._came_s[-1] - self._came_s[0]) if steps else 0.0

    def _clock(self) -> Finding:
        name, counters = f"clock of camera {self.source.camera}", self.source.counters
        if counters.clock == "sender":
            delay_ms = 1e3 * median(self._late_s)
            return Finding(name, "ok", f"known; images arrive after {delay_ms:.0f} ms (median)")
        text = counters.fault or "it is not told, so images are dated by their arrival"
        remedy = (
            "switch on NTP (date and time) in the camera's settings; a restreamer between the "
            "camera and this machine may drop its clock"
        )
        return Finding(name, "missing", text, remedy)


def _port(host: str, port: int) -> Finding:
    name = "port of the page"
    try:
        with socket.create_server((host, port)):
            return Finding(name, "ok", f"{host}:{port} is free")
    except OSError as error:
        remedy = f"end what listens there, or set another one in [page]: port = {port + 1}"
        return Finding(name, "broken", f"{host}:{port}: {error.strerror}", remedy, essential=True)


def _access(page: PageAddress) -> Finding:
    name = "access to the page"
    try:
        page.check()
    except InputError as error:
        text, _, remedy = str(error).partition("; ")
        remedy = remedy or "correct it under [page] in the site file"
        return Finding(name, "broken", text, remedy, essential=True)
    if page.remark is not None:
        remedy = "encrypt it under [page]: tls_cert and tls_key, or trusted_proxy"
        return Finding(name, "missing", page.remark, remedy)
    who = "everybody on this machine, without signing in" if page.is_open else "who signs in"
    return Finding(name, "ok", who)


def _output(output: DeliveryTable, site: Site) -> Finding:
    name = f"output {output.called}"
    try:
        return Finding(name, "ok", look_at(output, site))
    except Error as error:
        remedy = "start it or correct its table; events are kept until it takes them"
        return Finding(name, "broken", str(error), remedy)


def _broker(feed: str, table: FeedTable, site: Site) -> Finding:
    """Look at the broker of a feed; whether messages come is not tried."""
    name = f"broker of feed {feed}"
    try:
        broker = broker_of(table, site.outputs)
        answer = broker_answer(
            broker.url, broker.login(site.secrets), broker.ca, ANSWER_S, version=VERSION
        )
    except (Error, OSError) as error:
        return Finding(name, "broken", str(error), "start it or correct its table")
    return Finding(name, "ok", answer)


def _disk(folder: Path) -> Finding:
    there = next(one for one in (folder, *folder.absolute().parents) if one.exists())
    free_bytes = shutil.disk_usage(there).free
    text = f"{free_bytes / 1e9:.1f} GB free in {there}"
    if free_bytes < _LEAST_FREE_BYTES:
        return Finding(
            "disk of the site", "missing", text, "free some space: a day takes 1 to 10 GB"
        )
    return Finding("disk of the site", "ok", text)
