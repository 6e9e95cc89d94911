"""Bodies of requests: JSON of a known shape and size, or a clear refusal."""

from typing import TypeVar

import msgspec
from starlette.exceptions import HTTPException
from starlette.requests import Request

Body = TypeVar("Body")
LARGEST = 16_384  # bytes, where a route does not say otherwise


async def body_of(request: Request, kind: type[Body], largest: int = LARGEST) -> Body:
    """Return the body of a request.

    JSON has to say that it is JSON: a form on a page of another site cannot say so.

    Raises
    ------
    HTTPException
        It is none, has another shape, or is too large.
    """
    kind_given = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind_given != "application/json":
        raise HTTPException(415, "expected a body of the type application/json")
    parts = bytearray()
    async for part in request.stream():
        parts += part
        if len(parts) > largest:
            raise HTTPException(413, f"expected a body of at most {largest} bytes")
    try:
        return msgspec.json.decode(bytes(parts), type=kind)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise HTTPException(400, f"the body is not as expected: {error}") from None
