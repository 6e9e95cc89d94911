"""Events and the state of rules over MQTT."""

import json
import threading
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

from trecsim.cloud_events import event_text
from trecsim.outputs.base import Event, UndeliveredError
from trecsim.outputs.mqtt_client import (
    KEEPALIVE_S,
    LEAVE_S,
    SLOWEST_RETRY_S,
    client_of,
    leave,
    place_of,
)
from trecsim.outputs.onvif import onvif_message
from trecsim.outputs.rule_states import RuleStates
from trecsim.sources.streams.camera_login import Login

TIMEOUT_S = 10.0


class Mqtt:
    """Publishes events, and the state of each rule, which the broker retains.

    A broker that is lost is looked for by itself. Once it is there again, it is told that the site
    is online and the state of all rules.

    Parameters
    ----------
    url
        Of the broker.
    site
        Name of the site, part of all topics.
    states
        Follows the states of the rules.
    client_id
        By which the broker knows this output; no other client may have the same.
    login
        User and password; None for a broker that asks for none.
    ca
        Certificates by which the broker is known, in place of those of the system.
    onvif_prefix
        Where events are published as ONVIF's devices do, too; None for nowhere.
    timeout_s
        So long is waited for the broker [s].

    Raises
    ------
    SetupError
        When the package that speaks MQTT is not installed.
    """

    def __init__(
        self,
        url: str,
        site: str,
        states: RuleStates,
        *,
        client_id: str,
        login: Login | None = None,
        ca: Path | None = None,
        onvif_prefix: str | None = None,
        timeout_s: float = TIMEOUT_S,
    ) -> None:
        host, port = place_of(url)
        self._broker = f"{host}:{port}"
        self._states, self._onvif_prefix, self._timeout_s = states, onvif_prefix, timeout_s
        self._root = f"trecsim/{site}"
        self._changed = threading.Condition()
        self._is_connected = False
        self._fault = "no connection"
        self._acknowledged: set[int] = set()
        self._pending: tuple[str, list[int]] | None = None
        client = client_of(url, client_id, login, ca, timeout_s)
        client.will_set(f"{self._root}/status", "offline", qos=1, retain=True)
        client.reconnect_delay_set(1, SLOWEST_RETRY_S)
        client.on_connect, client.on_disconnect = self._connected, self._disconnected
        client.on_connect_fail, client.on_publish = self._not_connected, self._published
        self._client = client
        client.connect_async(host, port, keepalive=KEEPALIVE_S)
        client.loop_start()

    def deliver(self, event: Event, /) -> None:
        """Publish an event and the state that follows; see `Output`."""
        end_s = time.monotonic() + self._timeout_s
        self._wait_for_broker(end_s)
        if self._pending is None or self._pending[0] != event["id"]:
            self._pending = event["id"], self._publish_event(event)
        left = set(self._pending[1])
        with self._changed:
            while not left <= self._acknowledged:
                wait_s = end_s - time.monotonic()
                if wait_s <= 0.0 or not self._is_connected:
                    raise UndeliveredError(
                        f"the broker {self._broker} has not acknowledged an event within "
                        f"{self._timeout_s:g} s"
                    )
                self._changed.wait(wait_s)
            self._acknowledged -= left
        self._pending = None

    def close(self) -> None:
        """Tell the broker that the site is offline, and leave it."""
        told = self._client.publish(f"{self._root}/status", "offline", qos=1, retain=True)
        with self._changed:
            self._changed.wait_for(lambda: told.mid in self._acknowledged, LEAVE_S)
        leave(self._client)

    def _wait_for_broker(self, end_s: float) -> None:
        with self._changed:
            self._changed.wait_for(lambda: self._is_connected, end_s - time.monotonic())
            if not self._is_connected:
                raise UndeliveredError(f"the broker {self._broker}: {self._fault}")

    def _publish_event(self, event: Event) -> list[int]:
        rule = event["data"]["rule"]["id"]
        topics = [(f"{self._root}/events/{rule}", event_text(event), False)]
        if self._onvif_prefix is not None:
            made = onvif_message(event)
            topics.append((f"{self._onvif_prefix}/{made.topic}", made.body, made.retained))
        with self._changed:
            self._states.take(event)
            topics.append(self._state(rule))
        return self._publish(topics)

    def _publish(self, topics: Iterable[tuple[str, str, bool]]) -> list[int]:
        return [
            int(self._client.publish(topic, body, qos=1, retain=retain).mid)
            for topic, body, retain in topics
        ]

    def _state(self, rule: str) -> tuple[str, str, bool]:
        return f"{self._root}/state/{rule}", json.dumps(self._states.of(rule)), True

    def _connected(self, client: Any, data: Any, flags: Any, reason: Any, properties: Any) -> None:
        if reason.is_failure:
            self._set(False, f"refuses the connection: {reason}")
            return
        with self._changed:
            states = [self._state(rule) for rule in self._states.rules]
        self._publish([(f"{self._root}/status", "online", True), *states])
        self._set(True, "")

    def _disconnected(
        self, client: Any, data: Any, flags: Any, reason: Any, properties: Any
    ) -> None:
        if reason.is_failure:
            self._set(False, f"the connection was lost: {reason}")

    def _not_connected(self, client: Any, data: Any) -> None:
        self._set(False, "no connection")

    def _set(self, is_connected: bool, fault: str) -> None:
        with self._changed:
            was_refused = self._fault.startswith("refuses") and not is_connected
            self._is_connected = is_connected
            self._fault = self._fault if was_refused else fault
            self._changed.notify_all()

    def _published(self, client: Any, data: Any, mid: int, reason: Any, properties: Any) -> None:
        with self._changed:
            self._acknowledged.add(mid)
            self._changed.notify_all()


def broker_answer(
    url: str,
    login: Login | None,
    ca: Path | None,
    timeout_s: float,
    *,
    version: Literal[4, 5] = 4,
) -> str:
    """Return what a broker says to a client that connects and goes away again; see `client_of`.

    Raises
    ------
    UndeliveredError
        When it is not there, or refuses the connection.
    SetupError
        When the package that speaks MQTT is not installed.
    """
    host, port = place_of(url)
    answered, answers = threading.Event(), []

    def connected(client: Any, data: Any, flags: Any, reason: Any, properties: Any) -> None:
        answers.append(reason)
        answered.set()

    client = client_of(url, "", login, ca, timeout_s, version=version)
    client.on_connect = connected
    try:
        client.connect(host, port, keepalive=KEEPALIVE_S)
    except OSError as error:
        said = error.strerror or type(error).__name__
        raise UndeliveredError(f"the broker {host}:{port}: {said}") from None
    client.loop_start()
    answered.wait(timeout_s)
    leave(client)
    if not answers:
        raise UndeliveredError(f"the broker {host}:{port} has not answered within {timeout_s:g} s")
    if answers[0].is_failure:
        raise UndeliveredError(f"the broker {host}:{port} refuses the connection: {answers[0]}")
    return f"the broker {host}:{port} takes connections"
