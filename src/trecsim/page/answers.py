"""Answers in JSON."""

from starlette.responses import JSONResponse, Response

from trecsim.page.messages import json_bytes


def json_answer(body: object, status: int = 200) -> Response:
    """Return an answer in JSON; numbers that are missing become null."""
    return Response(json_bytes(body), status, media_type="application/json")


def error(status: int, what: str, headers: dict[str, str] | None = None) -> Response:
    """Return the answer to a request that cannot be fulfilled."""
    return JSONResponse({"error": what}, status, headers)
