"""Parameters in the address of a request."""

import math

from starlette.exceptions import HTTPException
from starlette.requests import Request

LONGEST = 200  # characters


def text_in(request: Request, name: str) -> str | None:
    """Return a parameter; None where it is not given.

    Raises
    ------
    HTTPException
        It is too long.
    """
    text = request.query_params.get(name)
    if text is not None and len(text) > LONGEST:
        raise HTTPException(400, f"{name}: expected at most {LONGEST} characters")
    return text


def number_in(request: Request, name: str, low: float = -1e12, high: float = 1e12) -> float | None:
    """Return a parameter as a number; None where it is not given.

    Raises
    ------
    HTTPException
        It is no number, or none between the limits.
    """
    text = text_in(request, name)
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise HTTPException(
            400, f"{name}: expected a number from {low:g} to {high:g}, not {text!r}"
        )
    return value
