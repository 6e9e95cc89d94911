"""The tables `[feeds.NAME]` of a site file: messages of other systems, and how they come."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from trecsim.sites.page_table import PageTable
from trecsim.sites.receiver_urls import url_of
from trecsim.sites.site_names import Name
from trecsim.toml_models import FilePath, Table
from trecsim.toml_models.toml_reading import Fault

Source = Literal["file", "http", "mqtt"]
SOURCES: tuple[Source, ...] = ("file", "http", "mqtt")
"""How messages may come: the keys of which a feed has one."""


_LONGEST_TOPIC = 200


def _topic(text: str) -> str:
    """Check a topic of MQTT, with wildcards or without."""
    levels = text.split("/")
    if (
        not 1 <= len(text) <= _LONGEST_TOPIC
        or not text.isprintable()
        or any("+" in one and one != "+" for one in levels)
        or any("#" in one and one != "#" for one in levels)
        or "#" in levels[:-1]
    ):
        raise ValueError(
            f"expected a topic of at most {_LONGEST_TOPIC} letters, as hall/tickets, in which + "
            f"stands for a level and # for all below, found {text[:60]!r}"
        )
    return text


def _no_folder(path: Path) -> Path:
    if path.is_dir():
        raise ValueError(f"expected a file with messages, found the folder {path}")
    return path


class FeedTable(Table):
    """A feed: messages of another system, such as access control or vehicles."""

    file: Annotated[FilePath, AfterValidator(_no_folder)] | None = None
    """File of messages, a line of JSON each; live, those that are appended while the site runs."""
    http: bool = False
    """Whether the messages are posted to the page: `POST /api/feeds/NAME`."""
    mqtt: Annotated[str, AfterValidator(_topic)] | None = None
    """Topic of an MQTT broker on which the messages are published."""
    broker: Annotated[str, url_of("mqtt", "mqtts")] | None = None
    """The broker: `mqtt://10.0.0.9:1883`, or `mqtts://` with encryption; that of the MQTT output,
    if not given."""
    credentials: Name | None = None
    """User and password at this broker, by their name: see `secrets`."""
    ca: FilePath | None = None
    """Certificates by which this broker is known; those of the system if not given."""
    silent_s: Annotated[float, Field(ge=0.0, le=86400.0)] = 30.0
    """Rules do not rely on the feed after so long without a message [s]; 0: they always do."""
    most_per_s: Annotated[float, Field(gt=0.0, le=10_000.0)] = 100.0
    """After more messages in a second, a flood, rules do not rely on the feed for 10 s."""

    @property
    def source(self) -> Source:
        """How its messages come."""
        return self._given()[0]

    @model_validator(mode="after")
    def _has_one_source(self) -> Self:
        given = self._given()
        if len(given) != 1:
            expected = ", ".join(SOURCES[:-1]) + f" and {SOURCES[-1]}"
            found = " and ".join(given) or "none"
            raise ValueError(f"expected one of {expected}, found {found}")
        if self.broker is not None and self.mqtt is None:
            raise ValueError(f"broker: only a feed with mqtt has one, found {given[0]}")
        extra = [key for key in ("ca", "credentials") if getattr(self, key) is not None]
        if extra and self.broker is None:
            raise ValueError(
                f"{' and '.join(extra)}: only beside broker; those of the MQTT output "
                "count where its broker does"
            )
        return self

    def _given(self) -> list[Source]:
        return [key for key in SOURCES if getattr(self, key) not in (None, False)]


def feed_source_faults(feeds: Mapping[str, FeedTable], page: PageTable | None) -> Iterator[Fault]:
    """Yield the feeds whose messages cannot come, as the site lacks what they come by."""
    for name, feed in feeds.items():
        if feed.http and page is None:
            yield (
                ("feeds", name, "http"),
                "messages are posted to the page: expected a table [page], found none",
            )


def feed_source_remarks(feeds: Mapping[str, FeedTable], page: PageTable | None) -> Iterator[str]:
    """Yield the feeds to which no program may post, which is probably not meant."""
    if page is None or page.feeds_token_env is not None:
        return
    if page.users is None and page.token_env is None:
        return
    for name, feed in feeds.items():
        if feed.http:
            yield (
                f"feeds.{name}.http: only admins who are signed in may post messages; for programs "
                "name a token under [page] as feeds_token_env"
            )
