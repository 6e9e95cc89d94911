"""Cameras that tests switch on, break and mend: each sends MPEG-TS on a port of this machine."""

import socket
import time
from collections.abc import Callable
from contextlib import closing, suppress
from fractions import Fraction
from threading import Event, Thread
from typing import Any, BinaryIO

import numpy as np
import pytest

av = pytest.importorskip("av")

PATIENCE_S = 60.0  # a loaded machine may take so long for what usually takes a moment


def until(condition: Callable[[], Any], what: str) -> Any:
    """Wait until a condition holds, and return what it returned; fail if it never does."""
    end_s = time.monotonic() + PATIENCE_S
    while not (found := condition()):
        assert time.monotonic() < end_s, f"waited in vain until {what}"
        time.sleep(0.01)
    return found


class MadeCamera:
    """A camera that sends images of one size to whoever connects.

    Attributes
    ----------
    size_px
        Of the images; may be changed while it sends.
    sends
        It sends while this is set.
    says
        Bytes to send in place of images.
    still
        Whether it sends the same image again and again.
    connections
        How many have come.
    """

    def __init__(self, size_px: tuple[int, int] = (64, 48), fps: int = 20) -> None:
        self.size_px, self.fps = size_px, fps
        self.sends, self.says, self.still = Event(), b"", False
        self.sends.set()
        self.connections = 0
        self._over = Event()
        self._open: list[socket.socket] = []
        self._listener: socket.socket | None = None
        self._port = 0
        self.switch_on()

    @property
    def url(self) -> str:
        return f"tcp://127.0.0.1:{self._port}"

    def switch_on(self) -> None:
        """Listen; on the same port as before."""
        self._listener = socket.create_server(("127.0.0.1", self._port))
        self._port = self._listener.getsockname()[1]
        Thread(target=self._accept, args=(self._listener,), daemon=True).start()

    def switch_off(self) -> None:
        """End all connections, and listen no more."""
        if self._listener is not None:
            with suppress(OSError):
                self._listener.shutdown(socket.SHUT_RDWR)
            self._listener.close()
        self.hang_up()

    def hang_up(self) -> None:
        """End all connections."""
        for one in self._open:
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
        self._open.clear()

    def close(self) -> None:
        self._over.set()
        self.switch_off()

    def _accept(self, listener: socket.socket) -> None:
        with suppress(OSError):
            while True:
                connection, _ = listener.accept()
                self.connections += 1
                self._open.append(connection)
                Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection: socket.socket) -> None:
        with closing(connection), suppress(OSError, av.FFmpegError):
            while not self._over.is_set():
                with closing(
                    Encoder(connection.makefile("wb", buffering=0), self.size_px, self.fps)
                ) as encoder:
                    self._send(connection, encoder)

    def _send(self, connection: socket.socket, encoder: "Encoder") -> None:
        """Send images of one size."""
        number = 0
        while encoder.size_px == self.size_px and not self._over.is_set():
            self.sends.wait()
            if self.says:
                connection.sendall(self.says)
            else:
                encoder.send(0 if self.still else number)
            number += 1
            self._over.wait(1.0 / self.fps)


class Encoder:
    """Writes images as MPEG-TS into a file; their stamps go on as time does."""

    def __init__(self, file: BinaryIO, size_px: tuple[int, int], fps: int) -> None:
        self.size_px = size_px
        self._file = av.open(file, "w", format="mpegts")
        self._stream = self._file.add_stream("libx264", rate=fps)
        self._stream.width, self._stream.height = size_px
        self._stream.pix_fmt = "yuv420p"
        self._stream.codec_context.time_base = Fraction(1, 1000)
        self._stream.options = {"tune": "zerolatency", "preset": "ultrafast", "g": "5"}
        self._last = -1

    def send(self, number: int) -> None:
        width, height = self.size_px
        image = np.full((height, width, 3), 40 + 7 * number % 160, np.uint8)
        frame = av.VideoFrame.from_ndarray(image, format="rgb24")
        frame.pts = self._last = max(self._last + 1, round(time.monotonic() * 1000) % 2**30)
        frame.time_base = self._stream.codec_context.time_base
        self._file.mux(self._stream.encode(frame))

    def close(self) -> None:
        with suppress(OSError, av.FFmpegError):
            self._file.close()


class JpegCamera:
    """Sends JPEG images over HTTP, as simple cameras do."""

    def __init__(self, fps: int, size_px: tuple[int, int] = (64, 48)) -> None:
        images = [np.full((size_px[1], size_px[0], 3), grey, np.uint8) for grey in (50, 90, 130)]
        self._parts = [_jpeg(image) for image in images]
        self._fps, self._over = fps, Event()
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self._listener.getsockname()[1]}/video.mjpg"
        Thread(target=self._accept, daemon=True).start()

    def close(self) -> None:
        self._over.set()
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                connection, _ = self._listener.accept()
                Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection: socket.socket) -> None:
        with closing(connection), suppress(OSError):
            connection.recv(1 << 16)
            kind = b"Content-Type: multipart/x-mixed-replace; boundary=part"
            connection.sendall(b"HTTP/1.0 200 OK\r\n" + kind + b"\r\n\r\n")
            number = 0
            while not self._over.wait(1.0 / self._fps):
                part = self._parts[number % len(self._parts)]
                head = f"--part\r\nContent-Type: image/jpeg\r\nContent-Length: {len(part)}\r\n\r\n"
                connection.sendall(head.encode() + part + b"\r\n")
                number += 1


def _jpeg(image: np.ndarray) -> bytes:
    context = av.CodecContext.create("mjpeg", "w")
    context.height, context.width = image.shape[:2]
    context.pix_fmt, context.time_base = "yuvj420p", Fraction(1, 25)
    frame = av.VideoFrame.from_ndarray(image, format="rgb24").reformat(format="yuvj420p")
    frame.pts = 0
    return b"".join(bytes(packet) for packet in [*context.encode(frame), *context.encode(None)])
