"""Where the page listens, and who may reach it there."""

import ipaddress
import os
import socket
import ssl
from dataclasses import dataclass
from pathlib import Path

from trecsim.errors import InputError
from trecsim.page.users_file import read_users

LOOPBACK_NAMES = ("localhost", "localhost.localdomain")
SHORTEST_TOKEN = 16  # characters
LAST_PORT = 65_535
BACKLOG = 128  # connections that wait while the page process starts
SEND_BUFFER_BYTES = 256 * 1024  # per viewer in the kernel; more would only hold old snapshots


@dataclass(frozen=True, slots=True)
class PageAddress:
    """Where the page listens, and what protects it.

    Attributes
    ----------
    host
        Address or name of a network interface of this machine.
    port
        TCP port; 0 takes a free one.
    hosts
        Further names under which browsers reach the page.
    users_file
        The file of the users who may sign in.
    token_env
        Name of the environment variable with the token of programs.
    tls_cert, tls_key
        Files of the certificate and its key, PEM; both or none.
    trusted_proxy
        Address of the reverse proxy whose `X-Forwarded-` headers count.
    insecure
        Whether passwords may come over plain HTTP from other machines.
    feeds_token_env
        Name of the environment variable with the token of systems that post messages of feeds.
    """

    host: str = "127.0.0.1"
    port: int = 8765
    hosts: tuple[str, ...] = ()
    users_file: Path | None = None
    token_env: str | None = None
    tls_cert: Path | None = None
    tls_key: Path | None = None
    trusted_proxy: str | None = None
    insecure: bool = False
    feeds_token_env: str | None = None

    @property
    def is_open(self) -> bool:
        """Whether everybody who reaches the page may use it."""
        return self.users_file is None and self.token_env is None

    @property
    def scheme(self) -> str:
        """The beginning of the page's address: http or https."""
        return "http" if self.tls_cert is None else "https"

    def check(self) -> None:
        """Check that the page is protected where other machines reach it.

        Raises
        ------
        InputError
            It is not, or a file or variable that protects it is missing.
        """
        if self.is_open and not is_loopback(self.host):
            raise InputError(
                f"[page] host = {self.host!r} is reached from other machines: expected users or "
                "token_env, found neither; make a user (trecsim users add NAME --role admin) and "
                'give users = "users.toml", or keep host = "127.0.0.1"'
            )
        if (self.tls_cert is None) != (self.tls_key is None):
            given, missing = ("cert", "key") if self.tls_cert else ("key", "cert")
            raise InputError(f"[page] has tls_{given}: expected tls_{missing} too, found none")
        if self.users_file is not None:
            there = self.users_file.is_file()
            if not there or not read_users(self.users_file):
                found = "it names nobody" if there else "there is no such file"
                raise InputError(
                    f"[page] users: expected users in {self.users_file}, but {found}; add "
                    f"somebody: trecsim users add NAME --role admin --file {self.users_file}"
                )
        if self.tls_cert is not None and self.tls_key is not None:
            _check_certificate(self.tls_cert, self.tls_key)
        token, feeds_token = self.token(), self.feeds_token()
        if token is not None and token == feeds_token:
            raise InputError(
                "[page] feeds_token_env: expected a token of its own, found that of token_env, "
                "which may do more; make another one"
            )

    @property
    def remark(self) -> str | None:
        """What people should know who use it so; None where there is nothing."""
        protected = self.tls_cert or self.trusted_proxy or is_loopback(self.host)
        if protected:
            return None
        if self.insecure:
            return "the page takes passwords over plain HTTP: others on the network can read them"
        return (
            "other machines can reach the page but not sign in: passwords need TLS (tls_cert and "
            "tls_key) or a trusted_proxy under [page]"
        )

    def token(self) -> str | None:
        """Return the token of programs from the environment; None where none is asked for.

        Raises
        ------
        InputError
            The variable is not set, or what it holds is easily guessed.
        """
        return _token_in("token_env", self.token_env)

    def feeds_token(self) -> str | None:
        """Return the token of systems that post messages of feeds; see `token`."""
        return _token_in("feeds_token_env", self.feeds_token_env)


def _token_in(key: str, variable: str | None) -> str | None:
    if variable is None:
        return None
    token = os.environ.get(variable, "")
    if len(token) < SHORTEST_TOKEN:
        found = f"one of {len(token)}" if token else "none"
        raise InputError(
            f"[page] {key}: expected a token of at least {SHORTEST_TOKEN} characters in "
            f"the environment variable {variable}, found {found}; make one: "
            "python -c 'import secrets; print(secrets.token_urlsafe())'"
        )
    if not is_token(token):
        raise InputError(
            f"[page] {key}: {variable} holds a space, a line break or a letter "
            "beyond ASCII, which no program can send; expected printable ASCII without spaces"
        )
    return token


def is_token(text: str) -> bool:
    """Tell whether a text can be sent as a token.

    Examples
    --------
    >>> [is_token(text) for text in ("a-token", "a-token ", "é")]
    [True, False, False]
    """
    return text.isascii() and text.isprintable() and " " not in text


def _check_certificate(cert: Path, key: Path) -> None:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    try:
        context.load_cert_chain(cert, key, password=b"")  # none is asked for
    except (OSError, ValueError) as error:  # OSError: also what is wrong in the files
        reason = getattr(error, "reason", None) or getattr(error, "strerror", None) or error
        raise InputError(
            f"[page] tls_cert, tls_key: expected a certificate and its key without a password, "
            f"both PEM, in {cert} and {key}: {reason}"
        ) from None


def is_loopback(host: str) -> bool:
    """Tell whether only this machine reaches an address.

    Examples
    --------
    >>> [is_loopback(host) for host in ("127.0.0.1", "::1", "localhost", "0.0.0.0", "10.0.0.2")]
    [True, True, True, False, False]
    """
    if host.lower().rstrip(".") in LOOPBACK_NAMES:
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def listen(address: PageAddress) -> socket.socket:
    """Return a socket that listens where the page shall be.

    Raises
    ------
    InputError
        The address is not one of this machine, or the port is taken.
    """
    if not 0 <= address.port <= LAST_PORT:  # the system would take it modulo 65536
        raise InputError(f"the page: expected a port from 0 to {LAST_PORT}, found {address.port}")
    host = address.host.strip("[]")
    listening: socket.socket | None = None
    try:
        family, kind, protocol, _, place = socket.getaddrinfo(
            host, address.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listening = socket.socket(family, kind, protocol)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)
        listening.bind(place)
        listening.listen(BACKLOG)
    except (OSError, UnicodeError, OverflowError) as error:
        if listening is not None:
            listening.close()
        raise InputError(_why_not(address, error)) from None
    return listening


def _why_not(address: PageAddress, error: Exception) -> str:
    where = f"the page cannot listen on {address.host} port {address.port}"
    if isinstance(error, PermissionError):
        return f"{where}: ports below 1024 belong to the system; give [page] another port"
    if isinstance(error, socket.gaierror) or not isinstance(error, OSError):
        return f"{where}: expected a name or address of this machine, found none of that name"
    return f"{where}: {error.strerror}; give [page] another host or port, or 0 for a free port"


def url_of(address: PageAddress, listening: socket.socket) -> str:
    """Return the address to open in a browser on this machine.

    A page on all interfaces is named by the loopback address.
    """
    host, port = listening.getsockname()[:2]
    if ipaddress.ip_address(host).is_unspecified:
        host = "::1" if ":" in host else "127.0.0.1"
    elif is_loopback(address.host):
        host = address.host.strip("[]")
    shown = f"[{host}]" if ":" in host else host
    return f"{address.scheme}://{shown}:{port}/"
