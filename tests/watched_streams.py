"""Live sources that are read in a thread, as the pipeline does."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread

from made_cameras import until
from trecsim.sources.streams import NetworkAddress, StreamSource
from trecsim.sources.streams.camera_login import Login
from trecsim.sources.streams.stream_address import Transport
from trecsim.values import Frame


class Watched:
    """A source that is read in a thread, as in the pipeline."""

    def __init__(self, source: StreamSource) -> None:
        self.source, self.counters = source, source.counters
        self.frames: list[Frame] = []
        self.thread = Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self) -> None:
        for frame in self.source:
            self.frames.append(frame)

    def images(self, more: int = 5) -> list[Frame]:
        """Wait for some more images, and return them."""
        before = len(self.frames)
        until(lambda: len(self.frames) >= before + more, f"{more} more images came")
        return self.frames[before:]

    def fault(self, text: str) -> str:
        """Wait until a fault is told."""
        until(lambda: text in (self.counters.fault or ""), f"{text!r} was told")
        return str(self.counters.fault)


@contextmanager
def watched(
    url: str,
    size_px: tuple[int, int],
    limit_px: tuple[int, int] | None = None,
    transport: Transport = "tcp",
    login: Login | None = None,
) -> Iterator[Watched]:
    address = NetworkAddress(url, transport, login, "gate" if login else None)
    one = Watched(StreamSource("north", address, size_px, limit_px))
    try:
        yield one
    finally:
        one.source.close()
    one.thread.join(10.0)
    assert not one.thread.is_alive()
