"""A camera that sends what no decoder expects."""

import io
import socket
from contextlib import closing, suppress
from random import Random
from threading import Thread

from made_cameras import Encoder, MadeCamera


def clip(images: int = 10) -> bytes:
    """Return a short video as MPEG-TS."""
    data = io.BytesIO()
    with closing(Encoder(data, (64, 48), 20)) as encoder:
        for number in range(images):
            encoder.send(number)
    return data.getvalue()


def mutated(data: bytes, random: Random) -> bytes:
    """Return data in which bytes are changed, lost and added."""
    found = bytearray(data)
    for _ in range(random.choice([1, 3, 10, 50])):
        at = random.randrange(len(found))
        match random.randrange(3):
            case 0:
                found[at] = random.randrange(256)
            case 1:
                del found[at : at + random.randrange(1, 200)]
            case _:
                found[at:at] = random.randbytes(random.randrange(1, 100))
    return bytes(found)


class HostileCamera:
    """Sends each of some texts to one connection; later ones are passed on to a good camera.

    Attributes
    ----------
    left
        What is still to be sent.
    """

    def __init__(self, texts: list[bytes], good: MadeCamera) -> None:
        self.left = texts
        self._good = good
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcp://127.0.0.1:{self._listener.getsockname()[1]}"
        Thread(target=self._accept, daemon=True).start()

    def close(self) -> None:
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                connection, _ = self._listener.accept()
                if not self.left:
                    Thread(target=self._pass_on, args=(connection,), daemon=True).start()
                    continue
                with closing(connection), suppress(OSError):
                    connection.sendall(self.left.pop())

    def _pass_on(self, connection: socket.socket) -> None:
        port = int(self._good.url.rpartition(":")[2])
        with (
            closing(connection),
            closing(socket.create_connection(("127.0.0.1", port))) as good,
            suppress(OSError),
        ):
            while data := good.recv(1 << 16):
                connection.sendall(data)
