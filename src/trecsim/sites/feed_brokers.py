"""The MQTT brokers of feeds: their own, or that of the output of the site."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from trecsim.errors import ConfigError, InputError
from trecsim.sites.feed_tables import FeedTable
from trecsim.sites.output_tables import DeliveryTable, MqttOutput
from trecsim.sources.streams.camera_login import Login, find_login
from trecsim.toml_models.toml_reading import Fault

VERSION: Final = 5
"""Of MQTT: in this one a client tells the broker how long messages may be."""


@dataclass(frozen=True, slots=True)
class Broker:
    """Where a broker is, and how it is known.

    Attributes
    ----------
    url
        As `mqtt://10.0.0.9:1883`.
    credentials
        The name of user and password; None for a broker that asks for none.
    ca
        Certificates by which it is known, in place of those of the system.
    """

    url: str
    credentials: str | None = None
    ca: Path | None = None

    def login(self, secrets: Path | None) -> Login | None:
        """Return user and password.

        Raises
        ------
        ConfigError
            When they cannot be found.
        """
        return None if self.credentials is None else find_login(self.credentials, secrets)


def broker_of(feed: FeedTable, outputs: Sequence[DeliveryTable]) -> Broker:
    """Return the broker of a feed: its own, else that of the only MQTT output of the site.

    Raises
    ------
    ConfigError
        When it has none, and the site has none or several.
    """
    if feed.broker is not None:
        return Broker(feed.broker, feed.credentials, feed.ca)
    known = [one for one in outputs if isinstance(one, MqttOutput)]
    if len(known) != 1:
        found = f"{len(known)} such outputs" if known else "neither"
        raise ConfigError(
            "expected a broker, or an MQTT output whose broker counts, found "
            f'{found}; write broker = "mqtt://..." below it'
        )
    return Broker(known[0].url, known[0].credentials, known[0].ca)


def feed_broker_faults(
    feeds: Mapping[str, FeedTable], outputs: Sequence[DeliveryTable]
) -> Iterator[Fault]:
    """Yield the feeds of which it is not known at which broker their messages are."""
    for name, feed in feeds.items():
        if feed.mqtt is not None:
            try:
                broker_of(feed, outputs)
            except ConfigError as error:
                yield ("feeds", name, "mqtt"), str(error)


def feed_broker_remarks(feeds: Mapping[str, FeedTable], secrets: Path | None) -> Iterator[str]:
    """Yield which credentials of brokers of feeds cannot be found."""
    for name, feed in feeds.items():
        if feed.credentials is not None:
            try:
                find_login(feed.credentials, secrets)
            except InputError as error:
                yield f"feeds.{name}.credentials: {error}"
