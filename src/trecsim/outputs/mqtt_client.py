"""Clients of MQTT brokers, as outputs and feeds need them."""

import threading
from pathlib import Path
from typing import Any, Literal
from urllib.parse import urlsplit

from trecsim.extras import needed
from trecsim.sources.streams.camera_login import Login

KEEPALIVE_S = 15
SLOWEST_RETRY_S = 30
LEAVE_S = 1.0
_PORTS = {"mqtt": 1883, "mqtts": 8883}


def place_of(url: str) -> tuple[str, int]:
    """Return host and port of a broker."""
    parts = urlsplit(url)
    return parts.hostname or "", parts.port or _PORTS[parts.scheme]


def client_of(
    url: str,
    client_id: str,
    login: Login | None,
    ca: Path | None,
    timeout_s: float,
    *,
    version: Literal[4, 5] = 4,
) -> Any:
    """Return a client that is not connected yet.

    Parameters
    ----------
    url
        Of the broker.
    client_id
        By which the broker knows the client; it gives "" a name.
    login
        User and password; None for a broker that asks for none.
    ca
        Certificates by which the broker is known, in place of those of the system.
    timeout_s
        So long is waited for a connection [s].
    version
        Of the protocol: 4 is MQTT 3.1.1, 5 is MQTT 5.

    Raises
    ------
    SetupError
        When the package that speaks MQTT is not installed.
    OSError
        When the certificates cannot be read.
    """
    paho = needed("MQTT needs paho-mqtt", "outputs", "paho.mqtt.client")
    client = paho.Client(paho.CallbackAPIVersion.VERSION2, client_id=client_id, protocol=version)
    client.connect_timeout = timeout_s
    if login is not None:
        client.username_pw_set(login.user, login.password)
    if urlsplit(url).scheme == "mqtts":
        client.tls_set(ca_certs=None if ca is None else str(ca))
    return client


def leave(client: Any) -> None:
    """End a connection in order: its socket is closed once the broker knows."""
    left = threading.Event()
    client.on_disconnect = lambda *given: left.set()
    client.disconnect()  # also where the broker has refused it, which leaves the socket open
    if client.socket() is not None:
        left.wait(LEAVE_S)
    client.loop_stop()
