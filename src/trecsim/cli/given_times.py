"""Moments as a person types them."""

from datetime import UTC, datetime

from trecsim.errors import InputError


def moment_s(text: str, option: str) -> float:
    """Return a moment in seconds: a number as in the recording, or a date and time.

    Examples
    --------
    >>> moment_s("12.5", "--from"), moment_s("2026-01-31T22:00", "--from")
    (12.5, 1769896800.0)
    >>> moment_s("2026-01-31T22:00+01:00", "--from")
    1769893200.0
    """
    try:
        return float(text)
    except ValueError:
        pass
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise InputError(
            f"{option}: expected seconds, or a date and time as 2026-01-31T22:00+01:00 (UTC where "
            f"no offset is given), found {text!r}"
        ) from None
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
