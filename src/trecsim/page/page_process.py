"""The page as the tracking process sees it: say what there is, never wait."""

import logging
import os
import socket
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector
from threading import Event, Thread
from time import monotonic
from typing import Any, Self

import msgspec

from trecsim.errors import Error, SetupError
from trecsim.extras import has_extra, install_command
from trecsim.health import Health
from trecsim.page.address import PageAddress, listen, url_of
from trecsim.page.last_seen import LastSeen
from trecsim.page.link import (
    FROM_PAGE,
    FeedLines,
    HealthPart,
    PageRequest,
    PicturePart,
    Setup,
    SitePart,
    receive_body,
)
from trecsim.page.outgoing import Outgoing
from trecsim.page.page_data import PageData
from trecsim.page.site_view import SiteView
from trecsim.safety.vehicle import PlacedVehicle
from trecsim.values import Snapshot

logger = logging.getLogger(__name__)

START_S = 60.0  # so long a page process may take to say the first thing;
HUNG_S = 15.0  # one that says nothing for so long later is started again
PAUSES_S = (0.2, 0.5, 1.0, 2.0, 5.0, 10.0)  # before it is started again, after each crash in a row
SETTLED_S = 60.0  # a process that ran for so long begins a new row
END_S = 1.0  # so long it may take to end
REQUESTS_KEPT = 100
_CREDENTIALS = "TRECSIM_CREDENTIALS_"


TakeLines = Callable[[str, Sequence[bytes]], None]
"""Takes the name of a feed, and messages of it that nobody has read yet; must not wait."""


def _take_none(feed: str, lines: Sequence[bytes]) -> None:
    """Drop messages of feeds, as a site does that has none."""


class PageProcess:
    """Runs the page in a process of its own and keeps it running.

    No method waits for the page process. Of snapshots, health, site and pictures only the newest is
    sent; events are sent in order, and again to a process that replaces one that crashed.

    Parameters
    ----------
    address
        Where it listens.
    site
        What it shows.
    data
        Files it reads.

    Attributes
    ----------
    url
        Where browsers on this machine find the page; it listens from the start.
    restarts
        How often a crashed page process was replaced.

    Raises
    ------
    InputError
        It cannot listen there, or is not protected there.
    SetupError
        Optional packages are missing.

    Examples
    --------
    ::

        with PageProcess(PageAddress(port=0), SiteView("hall")) as page:
            print("page:", page.url)
            page.write(snapshot)
    """

    def __init__(self, address: PageAddress, site: SiteView, data: PageData | None = None) -> None:
        if not has_extra("page"):
            raise SetupError(
                "the page needs packages that are not installed; install them: "
                + install_command("page")
            )
        address.check()
        if address.remark is not None:
            logger.warning("%s", address.remark)
        self._listening = listen(address)
        self.url = url_of(address, self._listening)
        self.restarts = 0
        self._setup = Setup(_plain(asdict(address)), self.url, _plain(asdict(data or PageData())))
        self._outgoing = Outgoing(SitePart(site.to_json()))
        self._seen = LastSeen()
        self._requests: deque[PageRequest] = deque(maxlen=REQUESTS_KEPT)
        self._take_lines: TakeLines = _take_none
        self._link: socket.socket | None = None
        self._ending = Event()
        self._runner = Thread(target=self._run, name="page", daemon=True)

    def __enter__(self) -> Self:
        self._runner.start()
        return self

    def __exit__(self, *ending: object) -> None:
        self._ending.set()
        if self._link is not None:
            _hang_up(self._link)
        self._runner.join(3 * END_S)
        self._listening.close()

    def write(self, snapshot: Snapshot, /, vehicles: Iterable[PlacedVehicle] = ()) -> None:
        """Show where everybody is, and the vehicles whose positions come from feeds."""
        self._outgoing.put_snapshot(snapshot, self._seen.ages_s(snapshot), tuple(vehicles))

    def health(self, health: Health) -> None:
        """Show how well the site works."""
        self._outgoing.put_health(HealthPart(health))

    def site(self, site: SiteView) -> None:
        """Show a site that has changed."""
        self._outgoing.put_site(SitePart(site.to_json()))

    def event(self, event: Mapping[str, Any], *, kept: bool = False) -> None:
        """Show an event: a CloudEvent as in ``events.jsonl``.

        Parameters
        ----------
        event
            The event.
        kept
            Whether it is in the ledger of the site. The page writes no event there but those of
            what people do, and, before these, the ones that they are about.
        """
        self._outgoing.put_event(dict(event), kept)

    def picture(self, camera: str, t_s: float, jpeg: bytes) -> None:
        """Show what a camera sees to those who look at it now; the page keeps none but the newest.

        Parameters
        ----------
        camera
            The camera.
        t_s
            When the image was taken [s].
        jpeg
            The image.
        """
        self._outgoing.put_picture(PicturePart(camera, t_s, jpeg))

    def feeds_to(self, take: TakeLines) -> None:
        """Hand messages of feeds that are posted to the page to `take`, in a thread of the page."""
        self._take_lines = take

    def requests(self) -> list[PageRequest]:
        """Return what people at the page have asked for since the last call."""
        found = []
        while self._requests:
            found.append(self._requests.popleft())
        return found

    def _run(self) -> None:
        crashes = 0
        while not self._ending.is_set():
            started_s = monotonic()
            why = self._run_once()
            if self._ending.is_set():
                return
            crashes = 0 if monotonic() - started_s > SETTLED_S else crashes
            pause_s = PAUSES_S[min(crashes, len(PAUSES_S) - 1)]
            crashes += 1
            self.restarts += 1
            logger.warning("the page process %s; it is started again in %g s", why, pause_s)
            self._ending.wait(pause_s)

    def _run_once(self) -> str:
        """Run one page process to its end; return what happened to it."""
        ours, theirs = socket.socketpair()
        with ours:
            with theirs:
                process = _start(self._listening, theirs)
            self._link = ours
            if self._ending.is_set():  # nobody else hangs up
                _hang_up(ours)
            sender = Thread(
                target=self._outgoing.send_to, args=(ours, self._setup), name="page link",
                daemon=True,
            )  # fmt: skip
            sender.start()
            silent = self._take_requests(ours)
            _hang_up(ours)
            ended = _end(process)
            sender.join()
        return silent or ended

    def _take_requests(self, link: socket.socket) -> str | None:
        """Take requests until the link ends; return what is wrong if the process still runs."""
        within_s = START_S
        while True:
            try:
                body = _received_within(link, within_s)
                if body is None:
                    return None
                message = FROM_PAGE.decode(body)
            except TimeoutError:
                return f"said nothing for {within_s:g} s"
            except (Error, msgspec.MsgspecError, RecursionError) as error:
                return f"sent what is no message: {error}"
            within_s = HUNG_S
            if isinstance(message, PageRequest):
                self._requests.append(message)
            elif isinstance(message, FeedLines):
                self._take_lines(message.feed, message.lines)


def _received_within(link: socket.socket, seconds: float) -> bytes | None:
    """Return the next message; the other end may also hang in the middle of one."""
    # A timeout of the socket itself would also hold for the thread that sends.
    with DefaultSelector() as selector:
        selector.register(link, EVENT_READ)

        def wait() -> None:
            if not selector.select(seconds):
                raise TimeoutError

        return receive_body(link, wait)


def _start(listening: socket.socket, link: socket.socket) -> subprocess.Popen[bytes]:
    """Start a page process that inherits both sockets.

    It gets a session of its own, so that Ctrl-C in a terminal leaves its ending to this process.
    """
    handles = listening.fileno(), link.fileno()
    return subprocess.Popen(
        [sys.executable, "-m", "trecsim.page", *map(str, handles)],
        pass_fds=handles,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        start_new_session=True,
        env=environment(),
    )


def environment() -> dict[str, str]:
    """Return the environment of a page process, which the passwords of cameras do not concern."""
    return {name: value for name, value in os.environ.items() if not name.startswith(_CREDENTIALS)}


def _hang_up(link: socket.socket) -> None:
    """End a link at both ends; threads that wait for it go on."""
    with suppress(OSError):
        link.shutdown(socket.SHUT_RDWR)


def _end(process: subprocess.Popen[bytes]) -> str:
    """Wait for a process without a link to end; return how it did."""
    try:
        code = process.wait(END_S)
    except subprocess.TimeoutExpired:
        process.kill()
        code = process.wait()
    return f"ended by signal {-code}" if code < 0 else f"ended with exit code {code}"


def _plain(values: Any) -> Any:
    """Return values with paths as text."""
    if isinstance(values, dict):
        return {key: _plain(value) for key, value in values.items()}
    return str(values) if isinstance(values, Path) else values
