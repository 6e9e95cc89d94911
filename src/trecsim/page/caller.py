"""Where a request comes from, and whether others can read it on its way."""

import ipaddress
from dataclasses import dataclass

from starlette.datastructures import Headers
from starlette.types import Scope

from trecsim.page.address import PageAddress, is_loopback


@dataclass(frozen=True, slots=True)
class Caller:
    """Where a request comes from.

    Attributes
    ----------
    address
        IP address of the client; behind the trusted proxy the one it names.
    is_encrypted
        Whether the client speaks TLS, to this page or to the trusted proxy.
    is_private
        Whether passwords may come this way.
    """

    address: str
    is_encrypted: bool
    is_private: bool


def caller_of(scope: Scope, address: PageAddress) -> Caller:
    """Return where a request comes from.

    Parameters
    ----------
    scope
        The request.
    address
        Says which proxy is trusted.
    """
    client = scope.get("client")
    peer = _plain(client[0]) if client else ""
    encrypted = scope["scheme"] in ("https", "wss")
    if address.trusted_proxy is not None and peer == _plain(address.trusted_proxy):
        peer = _plain(_added(scope, "x-forwarded-for") or peer)
        encrypted = _added(scope, "x-forwarded-proto") == "https"
    private = encrypted or is_loopback(peer) or address.insecure
    return Caller(peer, encrypted, private)


def _added(scope: Scope, name: str) -> str:
    """Return what the proxy itself added to a header: the last entry of the last line.

    All before it is what the client sent; some proxies add a line of their own to it.
    """
    lines = Headers(scope=scope).getlist(name)
    return lines[-1].rpartition(",")[2].strip() if lines else ""


def _plain(text: str) -> str:
    """Return an IP address in one way of writing; other text as it is, but short."""
    try:
        found = ipaddress.ip_address(text)
    except ValueError:
        return text[:64]
    mapped = getattr(found, "ipv4_mapped", None)
    return str(mapped or found)
