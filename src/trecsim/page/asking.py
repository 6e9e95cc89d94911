"""What the page asks the tracking process to do."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

from trecsim.page.link import FeedLines, PageRequest, framed

Ask = Callable[[str, str, dict[str, Any]], Awaitable[None]]
"""Takes what is asked, who asks, and details; see `PageRequest`."""


HandOn = Callable[[str, list[bytes]], Awaitable[None]]
"""Takes the name of a feed, and messages of it; see `FeedLines`."""


def asking_over(writer: asyncio.StreamWriter) -> Ask:
    """Return the way to ask over a link."""

    async def ask(kind: str, by: str, body: dict[str, Any]) -> None:
        writer.write(framed(PageRequest(kind, by, body)))
        await writer.drain()

    return ask


def handing_on_over(writer: asyncio.StreamWriter) -> HandOn:
    """Return the way to hand on messages of feeds over a link."""

    async def hand_on(feed: str, lines: list[bytes]) -> None:
        writer.write(framed(FeedLines(feed, lines)))
        await writer.drain()

    return hand_on
