"""MQTT against a real mosquitto, killed and started again."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from made_events import made_event
from receivers import Broker, free_port, mosquitto, until
from trecsim.outputs.base import UndeliveredError
from trecsim.outputs.delivery import Delivery
from trecsim.outputs.mqtt import Mqtt, broker_answer
from trecsim.outputs.mqtt_client import leave
from trecsim.outputs.rule_states import RuleStates
from trecsim.sources.streams.camera_login import Login
from trecsim.store.ledger import Ledger

paho = pytest.importorskip("paho.mqtt.client")

Message = tuple[str, Any, bool]


@contextmanager
def listening(broker: Broker, topic: str = "#") -> Iterator[list[Message]]:
    """Yield what a subscriber gets: topic, body, and whether the broker had retained it."""
    messages: list[Message] = []
    ready = threading.Event()
    client = paho.Client(paho.CallbackAPIVersion.VERSION2)
    client.on_message = lambda client, data, one: messages.append(
        (one.topic, _body(one.payload), one.retain)
    )
    client.on_subscribe = lambda *given: ready.set()
    client.connect("127.0.0.1", broker.port)
    client.subscribe(topic, 1)
    client.loop_start()
    assert ready.wait(30.0)
    try:
        yield messages
    finally:
        leave(client)


def _body(payload: bytes) -> Any:
    text = payload.decode()
    return json.loads(text) if text.startswith("{") else text


@contextmanager
def publishing(broker: Broker, **options: Any) -> Iterator[Mqtt]:
    options = {"client_id": "trecsim-hall-mqtt", "timeout_s": 5.0, **options}
    output = Mqtt(broker.url, "hall", RuleStates(["strip", "gate"]), **options)
    try:
        yield output
    finally:
        output.close()


def test_an_event_the_state_that_follows_and_the_status_are_where_others_look(
    tmp_path: Path,
) -> None:
    with Broker(tmp_path) as broker, listening(broker) as messages:
        with publishing(broker) as output:
            output.deliver(made_event())
            until(lambda: any(topic == "trecsim/hall/events/strip" for topic, *_ in messages))
            with listening(broker, "trecsim/hall/state/#") as late:
                until(lambda: len(late) == 2)
            states = {topic: (body["state"], body["count"]) for topic, body, _ in late}
            assert states == {
                "trecsim/hall/state/strip": ("active", 1), "trecsim/hall/state/gate": ("clear", 0),
            }  # fmt: skip
            assert all(retained for *_, retained in late)
            output.deliver(made_event(phase="end", seq=1))
        until(lambda: messages[-1][:2] == ("trecsim/hall/status", "offline"))
        with listening(broker) as later:
            until(lambda: len(later) == 3)
    got = {topic: body for topic, body, _ in later}
    assert got["trecsim/hall/state/strip"]["state"] == "clear"
    assert got["trecsim/hall/status"] == "offline"
    assert [body for topic, body, _ in messages if topic.startswith("trecsim/hall/events")] == [
        made_event(), made_event(phase="end", seq=1),
    ]  # fmt: skip


def test_a_site_that_is_killed_is_offline_for_all_who_look(tmp_path: Path) -> None:
    with (
        Broker(tmp_path) as broker,
        listening(broker, "trecsim/hall/status") as messages,
        publishing(broker) as output,
    ):
        output.deliver(made_event())
        until(lambda: messages == [("trecsim/hall/status", "online", False)])
        output._client.socket().shutdown(2)  # as when the process is gone
        until(lambda: ("trecsim/hall/status", "offline", False) in messages)


def test_a_broker_that_was_killed_gets_every_event_and_all_states_once_it_is_back(
    tmp_path: Path,
) -> None:
    events = [made_event(f"episode {n}") for n in range(5)]
    broker = Broker(tmp_path)
    with Ledger(tmp_path) as ledger:

        def make() -> Mqtt:
            states = RuleStates(["strip"])
            return Mqtt(broker.url, "hall", states, client_id="trecsim-hall-mqtt", timeout_s=0.5)

        with Delivery("mqtt", "mqtt", make, ledger, first_retry_s=0.05) as sending:
            ledger.append_event(events[0])  # there has never been a broker
            until(lambda: sending.health().fault is not None)
            with broker, listening(broker, "trecsim/hall/events/#") as first:
                for event in events[1:3]:
                    ledger.append_event(event)
                until(lambda: len({body["id"] for _, body, _ in first}) == 3)
                until(lambda: sending.health().queue == 0)
            for event in events[3:]:
                ledger.append_event(event)
            until(lambda: sending.health().fault is not None)
            with broker, listening(broker, "trecsim/hall/#") as second:
                until(lambda: sending.health().queue == 0)
                until(lambda: {topic for topic, *_ in second} >= {
                    "trecsim/hall/status", "trecsim/hall/state/strip", "trecsim/hall/events/strip",
                })  # fmt: skip
                until(lambda: second[-1][1]["count"] == 5
                      if second[-1][0].startswith("trecsim/hall/state") else False)  # fmt: skip
    got = [body["id"] for topic, body, _ in [*first, *second] if "/events/" in topic]
    assert list(dict.fromkeys(got)) == [event["id"] for event in events]


def test_a_broker_that_refuses_a_password_is_told_without_it(tmp_path: Path) -> None:
    with Broker(tmp_path, "allow_anonymous false\n") as broker:
        with (
            publishing(broker, login=Login("kim", "s3cret"), timeout_s=1.0) as output,
            pytest.raises(UndeliveredError, match="refuses the connection") as caught,
        ):
            output.deliver(made_event())
        assert "s3cret" not in str(caught.value)
        with pytest.raises(UndeliveredError, match="refuses the connection"):
            broker_answer(broker.url, Login("kim", "s3cret"), None, 5.0)


def test_the_doctor_tells_a_broker_that_is_there_from_one_that_is_not(tmp_path: Path) -> None:
    mosquitto()
    with Broker(tmp_path) as broker:
        assert "takes connections" in broker_answer(broker.url, None, None, 5.0)
    with pytest.raises(UndeliveredError, match="Connection refused"):
        broker_answer(f"mqtt://127.0.0.1:{free_port()}", None, None, 5.0)


def test_events_are_published_as_onvif_does_where_that_is_asked_for(tmp_path: Path) -> None:
    with Broker(tmp_path) as broker, listening(broker, "onvif/#") as messages:
        with publishing(broker, onvif_prefix="onvif/hall") as output:
            output.deliver(made_event())
        until(lambda: len(messages) == 1)
    topic, body, _ = messages[0]
    assert topic == "onvif/hall/onvif-ej/RuleEngine/FieldDetector/ObjectsInside/&strip"
    assert body["Source"] == {"Rule": "strip"}
    assert body["Data"] == {"ObjectId": "3", "IsInside": True, "State": True}
