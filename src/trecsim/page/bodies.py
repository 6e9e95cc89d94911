"""Bodies of requests: JSON of a known shape and size, or a clear refusal."""

from collections.abc import Sequence
from typing import TypeVar

import msgspec
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request

Body = TypeVar("Body")
JSON = "application/json"
LARGEST = 16_384  # bytes, where a route does not say otherwise


async def content_of(request: Request, types: Sequence[str], largest: int) -> bytes:
    """Return the body of a request as it came.

    Raises
    ------
    HTTPException
        It has none of these types, is too large, or its sender has left.
    """
    if type_of(request) not in types:
        raise HTTPException(415, f"expected a body of the type {' or '.join(types)}")
    parts = bytearray()
    try:
        async for part in request.stream():
            parts += part
            if len(parts) > largest:
                raise HTTPException(413, f"expected a body of at most {largest} bytes")
    except ClientDisconnect:  # whoever hangs up gets no answer, and must not fill the log
        raise HTTPException(400, "the request ended within its body") from None
    return bytes(parts)


def type_of(request: Request) -> str:
    """Return the type of the body of a request, without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


async def body_of(request: Request, kind: type[Body], largest: int = LARGEST) -> Body:
    """Return the body of a request.

    JSON has to say that it is JSON: a form on a page of another site cannot say so.

    Raises
    ------
    HTTPException
        It is none, has another shape, or is too large.
    """
    content = await content_of(request, (JSON,), largest)
    try:
        return msgspec.json.decode(content, type=kind)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise HTTPException(400, f"the body is not as expected: {error}") from None
