"""What the page asks the tracking process to do."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

from trecsim.page.link import PageRequest, framed

Ask = Callable[[str, str, dict[str, Any]], Awaitable[None]]
"""Takes what is asked, who asks, and details; see `PageRequest`."""


def asking_over(writer: asyncio.StreamWriter) -> Ask:
    """Return the way to ask over a link."""

    async def ask(kind: str, by: str, body: dict[str, Any]) -> None:
        writer.write(framed(PageRequest(kind, by, body)))
        await writer.drain()

    return ask
