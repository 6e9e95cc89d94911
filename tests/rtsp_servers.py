"""RTSP cameras in processes of their own, and a network between them and us that can be broken."""

import functools
import json
import signal
import socket
import struct
import subprocess
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from threading import Event, Thread

import numpy as np
import pytest

SYSTEM_PYTHON = "/usr/bin/python3"  # has the bindings of GStreamer, if any has
SCRIPT = Path(__file__).parent / "servers" / "rtsp_camera.py"
SIZE_PX = (320, 96)
FPS = 20
BLOCK_PX, BITS = 8, 48
_NEEDED = (
    "import gi; gi.require_version('GstRtspServer', '1.0'); "
    "from gi.repository import Gst, GstRtspServer; Gst.init(None); "
    "assert all(map(Gst.ElementFactory.find, ('appsrc', 'x264enc', 'rtph264pay')))"
)


@functools.cache
def is_installed() -> bool:
    """Tell whether this machine has the RTSP server of GStreamer."""
    with suppress(OSError):
        command = [SYSTEM_PYTHON, "-c", _NEEDED]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    return False


class RtspCamera:
    """An RTSP camera in a process of its own.

    Parameters
    ----------
    given
        What `servers/rtsp_camera.py` takes.
    """

    def __init__(self, **given: object) -> None:
        if not is_installed():
            pytest.skip("the RTSP server of GStreamer is not installed; .ci/servers does so")
        self._given = {"size_px": SIZE_PX, "fps": FPS, "port": 0, **given}
        self.switch_on()

    def url(self, path: str = "/cam", port: int | None = None) -> str:
        return f"rtsp://127.0.0.1:{port or self.port}{path}"

    def switch_on(self) -> None:
        """Start it; on the same port as before."""
        self._process = subprocess.Popen(
            [SYSTEM_PYTHON, str(SCRIPT), json.dumps(self._given)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        assert line.startswith("port "), "the camera does not start"
        self.port = self._given["port"] = int(line.split()[1])

    def say(self, command: str) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(command + "\n")
        self._process.stdin.flush()

    def freeze(self) -> None:
        self._process.send_signal(signal.SIGSTOP)

    def thaw(self) -> None:
        self._process.send_signal(signal.SIGCONT)

    def switch_off(self) -> None:
        self._process.kill()
        self._process.communicate()

    close = switch_off


@contextmanager
def rtsp_camera(**given: object) -> Iterator[RtspCamera]:
    with closing(RtspCamera(**given)) as camera:
        yield camera


def painted_s(image: np.ndarray) -> float:
    """Return the Unix time that an image shows [s]."""
    half = BLOCK_PX // 2
    columns = half + BLOCK_PX * np.arange(BITS // 2)
    bits = np.concatenate([image[row, columns, 1] > 128 for row in (half, half + BLOCK_PX)])
    return int("".join("1" if bit else "0" for bit in bits), 2) / 1000.0


class Network:
    """Passes RTSP over TCP on, and breaks it as told.

    Attributes
    ----------
    port
        Connect here in place of the camera.
    passes
        The camera's data passes while this is set.
    step_s
        Is added to the clock in the camera's sender reports [s].
    garbage
        Is sent once in place of the camera's next data.
    slow_s
        How long each packet takes [s].
    """

    def __init__(self, camera_port: int) -> None:
        self.passes, self.step_s, self.garbage, self.slow_s = Event(), 0.0, b"", 0.0
        self.passes.set()
        self._camera_port = camera_port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        Thread(target=self._accept, daemon=True).start()

    def close(self) -> None:
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                client, _ = self._listener.accept()
                camera = socket.create_connection(("127.0.0.1", self._camera_port))
                Thread(target=self._pass_requests, args=(client, camera), daemon=True).start()
                Thread(target=self._pass_data, args=(camera, client), daemon=True).start()

    def _pass_requests(self, client: socket.socket, camera: socket.socket) -> None:
        with suppress(OSError), closing(camera):
            while data := client.recv(1 << 16):
                camera.sendall(data)

    def _pass_data(self, camera: socket.socket, client: socket.socket) -> None:
        with suppress(OSError, EOFError), closing(client), camera.makefile("rb") as data:
            while True:
                part = _part(data)
                self.passes.wait()
                if self.garbage:
                    part, self.garbage = self.garbage, b""
                client.sendall(self._stepped(part))
                time.sleep(self.slow_s)

    def _stepped(self, part: bytes) -> bytes:
        """Return a part with the time of a sender report changed."""
        if not (self.step_s and part[:1] == b"$" and part[1] == 1 and part[5] == 200):
            return part
        (ntp,) = struct.unpack_from(">Q", part, 12)
        return part[:12] + struct.pack(">Q", ntp + int(self.step_s * 2**32)) + part[20:]


def _part(data: object) -> bytes:
    """Read a packet, or an answer, of RTSP."""
    first = _read(data, 1)
    if first == b"$":
        head = _read(data, 3)
        return first + head + _read(data, int.from_bytes(head[1:], "big"))
    text = first + _read_head(data)
    length = next(
        (int(line.split(b":")[1]) for line in text.lower().split(b"\r\n")
         if line.startswith(b"content-length")),
        0,
    )  # fmt: skip
    return text + _read(data, length)


def _read_head(data: object) -> bytes:
    text = b""
    while not text.endswith(b"\r\n\r\n"):
        text += _read(data, 1)
    return text


def _read(data: object, count: int) -> bytes:
    found = data.read(count)  # type: ignore[attr-defined]
    if len(found) < count:
        raise EOFError
    return bytes(found)
