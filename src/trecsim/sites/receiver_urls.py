"""Addresses of receivers and brokers in a site file; passwords stand elsewhere."""

from collections.abc import Sequence
from urllib.parse import SplitResult, parse_qsl, urlsplit

from pydantic import AfterValidator

from trecsim.redaction import redacted

_LONGEST = 2000
_SECRET_NAMES = ("pass", "pwd", "token", "secret", "apikey", "api_key")


def url_of(*schemes: str) -> AfterValidator:
    """Return a validator of addresses that begin with one of these schemes."""

    def checked(url: str) -> str:
        parts = _split(url, schemes)
        if parts.scheme not in schemes or not parts.hostname:
            begin = " or ".join(f"{scheme}://" for scheme in schemes)
            raise ValueError(f"expected a URL that begins with {begin}, found {_shown(url)}")
        if "@" in parts.netloc or any(_is_secret(key) for key, _ in parse_qsl(parts.query)):
            raise ValueError(
                "passwords and tokens do not belong into the URL. Leave them out of it, write "
                'credentials = "NAME" below it, and set the environment variable '
                "TRECSIM_CREDENTIALS_NAME, or name a file with a line for NAME as `secrets`"
            )
        return url

    return AfterValidator(checked)


def _is_secret(key: str) -> bool:
    return any(name in key.lower() for name in _SECRET_NAMES)


def _split(url: str, schemes: Sequence[str]) -> SplitResult:
    if len(url) > _LONGEST or not url.isprintable() or " " in url:
        raise ValueError(f"expected a URL of at most {_LONGEST} letters without spaces")
    try:
        parts = urlsplit(url)
        _ = parts.port
        (parts.hostname or "").encode("idna")  # raises a ValueError, too
    except ValueError:
        raise ValueError(
            f"expected a URL like {schemes[0]}://10.0.0.9, found {_shown(url)}"
        ) from None
    return parts


def _shown(url: str) -> str:
    return repr(redacted(url)[:60])
