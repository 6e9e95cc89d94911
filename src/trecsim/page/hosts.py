"""Which names and origins the page answers to: against DNS rebinding and foreign sites."""

import ipaddress
import socket
from collections.abc import Collection, Mapping

from trecsim.page.address import LOOPBACK_NAMES, PageAddress


def names_of(address: PageAddress) -> frozenset[str]:
    """Return the names, in lower case, under which browsers may reach the page."""
    own = (address.host, socket.gethostname(), *LOOPBACK_NAMES)
    return frozenset(name.lower() for name in (*own, *address.hosts))


def is_known(host: str | None, names: Collection[str]) -> bool:
    """Tell whether a request for a host is meant for this page.

    A foreign name that leads here belongs to a site that wants its visitors' browsers to read this
    page for it. Numbers cannot be such a name.

    Parameters
    ----------
    host
        The header `Host`: a name or number, and perhaps a port.
    names
        The page's own names.

    Examples
    --------
    >>> [is_known(host, {"localhost"}) for host in ("localhost:8765", "10.0.0.2", "evil.example")]
    [True, True, False]
    """
    name = _without_port(host or "").lower().rstrip(".")
    if name in names:
        return True
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def is_own_origin(headers: Mapping[str, str]) -> bool:
    """Tell whether a request comes from the page itself, or from a program and not a browser.

    Browsers name the page that asks in `Origin`, for everything that changes something and for
    every WebSocket; programs need not.
    """
    if headers.get("sec-fetch-site", "same-origin") not in ("same-origin", "none"):
        return False
    origin = headers.get("origin")
    if origin is None:
        return True
    scheme, _, place = origin.partition("://")
    return scheme in ("http", "https") and bool(place) and place == headers.get("host")


def _without_port(host: str) -> str:
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.partition(":")[0]
