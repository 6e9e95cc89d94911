"""Feeds by MQTT, against a real mosquitto, killed and started again."""

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from time import time
from typing import Any

import pytest

from made_rigs import ring
from receivers import Broker, until
from trecsim.calibration import write_rig
from trecsim.outputs.mqtt_client import leave
from trecsim.safety.signals import Feed, Signal, Signals
from trecsim.service.live_feeds import LiveFeeds, subscription_of
from trecsim.service.subscription import LARGEST_PACKET
from trecsim.service.waiting_lines import LEAST_LINES
from trecsim.sites import read_site
from trecsim.sites.feed_tables import FeedTable
from trecsim.sites.site_file import Site

paho = pytest.importorskip("paho.mqtt.client")

Publish = Callable[..., None]
GRANT = {"t_s": 4.0, "grant": "gate"}


def site_of(folder: Path, broker: Broker, more: str = "") -> Site:
    """Return a site with an MQTT output."""
    write_rig(ring(3), folder / "rig.toml")
    (folder / "a.poses.jsonl").write_text("")
    (folder / "site.toml").write_text(
        'format = "trecsim.site/1"\nname = "hall"\nrig = "rig.toml"\nposes = "a.poses.jsonl"\n'
        f'{more}[[outputs]]\nkind = "mqtt"\nurl = "{broker.url}"\n'
    )
    return read_site(folder / "site.toml").site


@contextmanager
def publishing(broker: Broker) -> Iterator[Publish]:
    """Yield what publishes a message, and waits until the broker has it."""
    ready = threading.Event()
    client = paho.Client(paho.CallbackAPIVersion.VERSION2)
    client.on_connect = lambda *given: ready.set()
    client.connect("127.0.0.1", broker.port)
    client.loop_start()
    assert ready.wait(30.0)

    def publish(topic: str, message: Any, *, retain: bool = False) -> None:
        body = message if isinstance(message, bytes) else json.dumps(message).encode()
        client.publish(topic, body, qos=1, retain=retain).wait_for_publish(30.0)

    try:
        yield publish
    finally:
        leave(client)


def heard(feeds: LiveFeeds, publish: Publish, topic: str) -> None:
    """Publish signs of life until one comes: the subscription is there."""

    def comes() -> bool:
        publish(topic, {"t_s": 1.0})
        return bool(feeds(2.0))

    until(comes)


def taken(feeds: LiveFeeds, count: int) -> list[Signal]:
    """Return so many messages as soon as they are there, without signs of life."""
    found: list[Signal] = []

    def are_there() -> bool:
        found.extend(one for one in feeds(5.0) if one.what != "alive")
        return len(found) >= count

    until(are_there)
    return found


def test_messages_of_a_topic_come_once_and_nothing_that_the_broker_had_retained(
    tmp_path: Path,
) -> None:
    with Broker(tmp_path) as broker, publishing(broker) as publish:
        site = site_of(tmp_path, broker)
        publish("hall/gates/old", GRANT, retain=True)
        feeds = LiveFeeds({"f": FeedTable(mqtt="hall/gates/+")}, partial(subscription_of, site))
        with feeds:
            heard(feeds, publish, "hall/gates/west")
            publish("hall/other", {**GRANT, "people": 9})
            publish("hall/gates/west", json.dumps(GRANT, indent=1).encode())
            publish("hall/gates/east", b"{")
            found = taken(feeds, 2)
    assert [(one.feed, one.what, one.about, one.people) for one in found] == [
        ("f", "grant", "gate", 1), ("f", "unreadable", "", 1),
    ]  # fmt: skip


def test_a_broker_that_vanishes_makes_the_feed_silent_until_it_is_back(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    broker = Broker(tmp_path)
    site = site_of(tmp_path, broker)
    signals = Signals([Feed("f", silent_s=30.0)])
    feeds = LiveFeeds({"f": FeedTable(mqtt="gates")}, partial(subscription_of, site))
    with feeds:
        until(lambda: "no connection" in caplog.text)  # there has never been a broker
        for _ in range(2):
            with broker, publishing(broker) as publish:
                heard(feeds, publish, "gates")
                publish("gates", {"t_s": time(), "grant": "gate"})
                (grant,) = taken(feeds, 1)
                signals.take([grant])
                assert signals.fault("f", grant.taken_s) is None
        until(lambda: caplog.text.count("is there again") == 2)
        until(lambda: caplog.messages[-1].endswith("it is tried again"))
        assert feeds(100.0) == []
        assert signals.fault("f", 100.0) == ("feed f is silent: no message for more than 30 s")


def test_a_broker_that_refuses_a_password_is_told_without_it(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TRECSIM_CREDENTIALS_YARD", "kim:s3cret")
    with Broker(tmp_path, "allow_anonymous false\n") as broker:
        site = site_of(tmp_path, broker)
        own = FeedTable(mqtt="gates", broker=broker.url, credentials="yard")
        with LiveFeeds({"f": own}, partial(subscription_of, site)):
            until(lambda: "refuses the connection" in caplog.text)
    assert "s3cret" not in caplog.text


def test_a_broker_that_refuses_the_topic_is_told_and_nothing_says_that_it_is_tried_again(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    class Refusal:
        is_failure = True

        def __str__(self) -> str:
            return "Not authorized"

    site = site_of(tmp_path, Broker(tmp_path))
    table = FeedTable(mqtt="gates")
    with LiveFeeds({"f": table}, partial(subscription_of, site)) as feeds:
        until(lambda: "no connection" in caplog.text)
        subscription = feeds._feeds["f"].subscription
        assert subscription is not None
        subscription._subscribed(None, None, 1, [Refusal()], None)
    (told,) = (one for one in caplog.messages if "topic" in one)
    assert "refuses the topic gates: Not authorized; let its user read that" in told
    assert "tried again" not in told


def test_a_feed_without_its_credentials_is_told_and_stops_nobody(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    broker = Broker(tmp_path)
    site = site_of(tmp_path, broker)
    for table, said in (
        (FeedTable(mqtt="g", broker="mqtt://127.0.0.1", credentials="none"), "no credentials"),
        (FeedTable(mqtt="g", broker="mqtts://127.0.0.1", ca=tmp_path / "none.pem"), "No such file"),
    ):
        with LiveFeeds({"f": table}, partial(subscription_of, site)) as feeds:
            assert feeds(1.0) == []
        assert said in caplog.messages[-1]
        assert caplog.messages[-1].startswith("feed f: ")


def test_another_topic_counts_from_then_on_and_a_feed_that_stays_is_not_interrupted(
    tmp_path: Path,
) -> None:
    with Broker(tmp_path) as broker, publishing(broker) as publish:
        subscribe = partial(subscription_of, site_of(tmp_path, broker))
        stays, before = FeedTable(mqtt="stays"), FeedTable(mqtt="before")
        with LiveFeeds({"s": stays, "f": before}, subscribe) as feeds:
            heard(feeds, publish, "stays")
            heard(feeds, publish, "before")
            first = feeds._feeds["s"].subscription
            limits = FeedTable(mqtt="stays", silent_s=3.0)
            feeds.change({"s": limits, "f": FeedTable(mqtt="after")})
            assert feeds._feeds["s"].subscription is first
            heard(feeds, publish, "after")
            publish("before", {"t_s": 3.0, "grant": "before"})
            publish("stays", {"t_s": 3.0, "grant": "stays"})
            publish("after", {"t_s": 3.0, "grant": "after"})
            found = sorted((one.feed, one.about) for one in taken(feeds, 2))
    assert found == [("f", "after"), ("s", "stays")]


def test_a_flood_and_messages_without_end_take_bounded_memory(tmp_path: Path) -> None:
    with Broker(tmp_path) as broker, publishing(broker) as publish:
        subscribe = partial(subscription_of, site_of(tmp_path, broker))
        table = FeedTable(mqtt="gates", most_per_s=0.1)
        with LiveFeeds({"f": table}, subscribe) as feeds:
            heard(feeds, publish, "gates")
            publish("gates", b" " * (2 * LARGEST_PACKET))  # the broker leaves it out
            publish("gates", b" " * 5000 + b"1")
            for _ in range(LEAST_LINES + 20):
                publish("gates", {"t_s": 3.0})
            waiting = feeds._feeds["f"].waiting
            until(lambda: waiting._dropped > 0)
            found = feeds(5.0)
    assert len(found) <= LEAST_LINES + 1
    dropped, too_long = [one.note for one in found if one.what == "unreadable"]
    assert dropped.endswith("messages were dropped: too many came at once")
    assert too_long == "a message is longer than 4096 bytes"
