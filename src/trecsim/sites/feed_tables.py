"""The tables `[feeds.NAME]` of a site file: messages of other systems, and how they come."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from trecsim.sites.page_table import PageTable
from trecsim.toml_models import FilePath, Table
from trecsim.toml_models.toml_reading import Fault

Source = Literal["file", "http"]
SOURCES: tuple[Source, ...] = ("file", "http")
"""How messages may come: the keys of which a feed has one."""


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
