"""Messages of a feed that are published at an MQTT broker."""

import logging
import threading
import time
from importlib import import_module
from secrets import token_hex
from typing import Any

from trecsim.outputs.mqtt_client import (
    KEEPALIVE_S,
    SLOWEST_RETRY_S,
    client_of,
    leave,
    place_of,
)
from trecsim.service.waiting_lines import WaitingLines
from trecsim.sites.feed_brokers import VERSION, Broker
from trecsim.sources.streams.camera_login import Login

logger = logging.getLogger(__name__)

CONNECT_S = 5.0
"""So long is waited for the broker at each try [s]."""
LARGEST_PACKET = 16_384
"""The broker leaves out what is longer [bytes]; see `LONGEST_LINE`."""
MOST_AT_ONCE = 100
"""So many messages may wait to be acknowledged."""
FLOOD_PAUSE_S = 0.01
"""After each message for which there is no room no more is read for so long [s]."""
_QOS, _NO_RETAINED = 1, 2


class Subscription:
    """Takes the messages of a topic; a broker that is lost is looked for by itself.

    It speaks MQTT 5, in which a client tells the broker how long messages may be. What the broker
    had retained is no message: nobody knows how old it is.

    Parameters
    ----------
    feed
        Name of the feed.
    topic
        Where its messages are published.
    broker, login
        Where the broker is, and user and password; None for one that asks for none.
    waiting
        Takes the messages.
    client_id
        The beginning of the name by which the broker knows this subscription.

    Raises
    ------
    SetupError
        When the package that speaks MQTT is not installed.
    OSError
        When the certificates cannot be read.
    """

    def __init__(
        self,
        feed: str,
        topic: str,
        broker: Broker,
        login: Login | None,
        waiting: WaitingLines,
        *,
        client_id: str,
    ) -> None:
        self._feed, self._topic, self._waiting = feed, topic, waiting
        host, port = place_of(broker.url)
        self._broker = f"{host}:{port}"
        self._fault: str | None = None
        # A name of its own each time: one that is being closed must not be taken for this one.
        name = f"{client_id}-{token_hex(3)}"
        client = client_of(broker.url, name, login, broker.ca, CONNECT_S, version=VERSION)
        client.reconnect_delay_set(1, SLOWEST_RETRY_S)
        client.on_connect, client.on_disconnect = self._connected, self._disconnected
        client.on_connect_fail, client.on_subscribe = self._not_connected, self._subscribed
        client.on_message = self._take
        self._client = client
        client.connect_async(host, port, keepalive=KEEPALIVE_S, properties=_limits())
        client.loop_start()

    def close(self) -> threading.Thread:
        """Leave the broker, in a thread that is returned: a broker that hangs holds up nobody."""
        leaving = threading.Thread(
            target=leave, args=(self._client,), name=f"leave {self._feed}", daemon=True
        )
        leaving.start()
        return leaving

    def _take(self, client: Any, data: Any, message: Any) -> None:
        """Take a message: one, though it may have several lines."""
        if message.retain:
            return
        if self._waiting.put([message.payload.replace(b"\n", b" ")]):
            time.sleep(FLOOD_PAUSE_S)

    def _connected(self, client: Any, data: Any, flags: Any, reason: Any, properties: Any) -> None:
        if reason.is_failure:
            self._say(f"refuses the connection: {reason}; it is tried again")
            return
        options = import_module("paho.mqtt.subscribeoptions")
        wanted = options.SubscribeOptions(qos=_QOS, retainHandling=_NO_RETAINED)
        client.subscribe(self._topic, options=wanted)

    def _subscribed(self, client: Any, data: Any, mid: int, reasons: Any, properties: Any) -> None:
        refused = next((one for one in reasons if one.is_failure), None)
        said = f"refuses the topic {self._topic}: {refused}; let its user read that"
        self._say(None if refused is None else said)

    def _disconnected(
        self, client: Any, data: Any, flags: Any, reason: Any, properties: Any
    ) -> None:
        if reason.is_failure and self._fault is None:
            self._say(f"the connection was lost: {reason}; it is tried again")

    def _not_connected(self, client: Any, data: Any) -> None:
        self._say(self._fault or "no connection; it is tried again")

    def _say(self, fault: str | None) -> None:
        """Log what is wrong with the broker, or that nothing is any more: each once."""
        if fault == self._fault:
            return
        self._fault = fault
        if fault is None:
            logger.warning("feed %s: the broker %s is there again", self._feed, self._broker)
        else:
            logger.warning("feed %s: the broker %s: %s", self._feed, self._broker, fault)


def _limits() -> Any:
    """Return what the broker is told about messages."""
    properties = import_module("paho.mqtt.properties")
    packets = import_module("paho.mqtt.packettypes")
    limits = properties.Properties(packets.PacketTypes.CONNECT)
    limits.MaximumPacketSize = LARGEST_PACKET
    limits.ReceiveMaximum = MOST_AT_ONCE
    return limits
