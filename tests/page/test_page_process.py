"""The page process from the outside: it starts, is restarted, and never outlives its parent."""

import os
import signal
import socket
import subprocess
import sys
from contextlib import ExitStack, suppress
from pathlib import Path
from threading import Thread, Timer
from time import sleep, time

import httpx
import pytest
from websockets.exceptions import ConnectionClosed

from made_page import SITE, event, next_of, running_page, until, well
from made_tracks import snapshot
from page_processes import children, is_running, linux, process_of
from trecsim.errors import InputError, SetupError
from trecsim.page import page_process
from trecsim.page.address import PageAddress
from trecsim.page.link import LARGEST_BYTES
from trecsim.page.page_process import PageProcess


def test_the_port_listens_before_the_page_process_runs() -> None:
    process = PageProcess(PageAddress(port=0), SITE)
    port = httpx.URL(process.url).port
    assert port is not None
    with socket.create_connection(("127.0.0.1", port), timeout=5), process:
        assert httpx.get(process.url, timeout=20).status_code == 200


def test_a_port_in_use_is_one_clear_error() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(InputError, match=f"port {port}: Address already in use; give"):
            PageProcess(PageAddress(port=port), SITE)


@pytest.mark.parametrize("host", ["no.such.host.invalid", "", "a" * 300, "a..b"])
def test_a_host_that_is_not_this_machine_is_one_clear_error(host: str) -> None:
    with pytest.raises(InputError, match=r"\[page\]|the page cannot listen"):
        PageProcess(PageAddress(host=host, port=0, insecure=True), SITE)


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.7"])
def test_without_users_nothing_but_loopback_is_allowed(host: str) -> None:
    with pytest.raises(InputError, match="expected users or token_env, found neither"):
        PageProcess(PageAddress(host=host, port=0), SITE)


def test_without_the_extra_the_command_that_installs_it_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(page_process, "has_extra", lambda extra: extra != "page")
    with pytest.raises(SetupError, match=r"install .*\[page\]"):
        PageProcess(PageAddress(port=0), SITE)


@linux
def test_a_page_process_that_was_killed_is_replaced_and_viewers_miss_no_event() -> None:
    with running_page() as page:
        page.process.health(well())
        page.process.event(event("before"))
        until(lambda: page.client.get("/api/health").status_code == 200)
        os.kill(process_of(page), signal.SIGKILL)
        page.process.event(event("after"))
        until(lambda: page.process.restarts == 1)
        page.process.write(snapshot(time(), [1]))
        with page.stream("?last_event_id=before") as stream:
            assert next_of(stream, "event")["event"]["id"] == "after"
            assert next_of(stream, "snapshot")["people"][0]["person"] == 1
        assert page.client.get("/api/site").json()["site"]["name"] == "hall"


@linux
def test_a_signal_to_all_processes_leaves_the_page_to_its_parent() -> None:
    with running_page() as page:
        page.client.get("/api/health")
        os.kill(process_of(page), signal.SIGINT)
        os.kill(process_of(page), signal.SIGTERM)
        sleep(0.3)
        assert page.client.get("/api/health").status_code == 503
        assert page.process.restarts == 0


PARENT = """
import sys
from made_page import SITE
from trecsim.page.address import PageAddress
from trecsim.page.link import LARGEST_BYTES
from trecsim.page.page_process import PageProcess
with PageProcess(PageAddress(port=0), SITE) as page:
    print(page.url, flush=True)
    sys.stdin.read()
"""


@linux
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_the_page_of_a_parent_that_was_killed_ends_and_of_one_that_hangs_says_so(
    how: signal.Signals,
) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", PARENT], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    ) as parent, httpx.Client(timeout=20) as client:  # fmt: skip
        assert parent.stdout is not None
        url = parent.stdout.readline().strip()
        client.get(f"{url}api/health")
        child = children(parent.pid)[0]
        os.kill(parent.pid, how)
        if how == signal.SIGKILL:
            until(lambda: not is_running(child))
        else:
            until(lambda: "has said nothing for" in client.get(f"{url}api/health").text)
            assert client.get(f"{url}api/health").status_code == 503
            os.kill(parent.pid, signal.SIGKILL)


@linux
def test_the_page_ends_with_the_block_and_leaves_the_port() -> None:
    with ExitStack() as viewers:
        with running_page() as page:
            viewer = viewers.enter_context(page.stream())
            next_of(viewer, "health")
            process = process_of(page)
        with pytest.raises(ConnectionClosed):
            next_of(viewer, "none of this kind")
    assert not is_running(process)
    socket.create_server(("127.0.0.1", page.port)).close()


@linux
def test_the_page_process_has_no_passwords_of_cameras(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TRECSIM_CREDENTIALS_NORTH", "admin:s3cret")
    with running_page() as page:
        environment = Path(f"/proc/{process_of(page)}/environ").read_bytes()
    assert b"PATH=" in environment
    assert b"s3cret" not in environment


@linux
def test_the_page_process_gives_way_to_the_tracking() -> None:
    own = os.getpriority(os.PRIO_PROCESS, 0)
    with running_page() as page:
        page.client.get("/api/health")  # it has begun
        assert os.getpriority(os.PRIO_PROCESS, process_of(page)) == min(19, own + 5)


@pytest.mark.parametrize(
    "sent",
    [
        b"\x81\xa4type\xa4none",
        b"\x84\xa4type\xa7request\xa4kind\xa1k\xa2by\xa1b\xa4body\x81\xa1x"
        + b"\x91" * 50_000
        + b"\x01",
        b"\x83\xa4type\xa4feed\xa4feed\xa2\xff\xfe\xa5lines\x90",
        bytes(LARGEST_BYTES + 1),
    ],
)
def test_a_page_process_that_sends_nonsense_is_replaced_and_harms_nobody(sent: bytes) -> None:
    page = PageProcess(PageAddress(port=0), SITE)
    ours, theirs = socket.socketpair()
    with ours, theirs, page._listening:
        sending = Thread(target=_send, args=(theirs, len(sent).to_bytes(4, "big") + sent))
        sending.start()
        assert (page._take_requests(ours) or "").startswith("sent what is no message: ")
        ours.shutdown(socket.SHUT_RDWR)
        sending.join()


@pytest.mark.parametrize("sent", [b"", b"\x00\x00", b"\x00\x00\x00\x09half"])
def test_a_page_process_that_hangs_in_the_middle_of_a_message_is_replaced(
    sent: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page_process, "START_S", 0.2)
    page = PageProcess(PageAddress(port=0), SITE)
    ours, theirs = socket.socketpair()
    with ours, theirs, page._listening:
        theirs.sendall(sent)
        ending = Timer(10.0, ours.shutdown, (socket.SHUT_RDWR,))
        ending.start()
        assert page._take_requests(ours) == "said nothing for 0.2 s"
        ending.cancel()


def _send(link: socket.socket, content: bytes) -> None:
    with suppress(OSError):  # who does not want all of it hangs up
        link.sendall(content)
