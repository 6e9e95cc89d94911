"""Events as e-mail, for people who are not at the page."""

import smtplib
import ssl
from collections.abc import Callable, Iterable, Sequence
from datetime import datetime, tzinfo
from email.message import EmailMessage
from typing import Any
from urllib.parse import urlsplit

from trecsim.cloud_events import UNIX_FROM_S
from trecsim.outputs.base import Event, UndeliveredError
from trecsim.sources.streams.camera_login import Login

TIMEOUT_S = 20.0
_PORTS = {"smtp": 25, "smtps": 465}
_SEVERITIES = ("info", "warning", "alarm", "critical")
_ADVICE = "trecsim is advisory: it is no certified safety function."


class Mail:
    """Sends one message when something happens, and one each time that it gets worse.

    Parameters
    ----------
    url
        Of the mail server.
    sender, to
        Addresses.
    earlier
        Returns all events of an episode that came before an event, the oldest first.
    zone
        Time zone of the site.
    login
        User and password; None for a server that asks for none.
    starttls
        Whether the connection is encrypted once it is there (STARTTLS).
    page_url
        Where the page is, for a link in the message.
    timeout_s
        So long is waited for the server [s].
    """

    def __init__(
        self,
        url: str,
        sender: str,
        to: Sequence[str],
        earlier: Callable[[Event], Iterable[Event]],
        zone: tzinfo,
        *,
        login: Login | None = None,
        starttls: bool = False,
        page_url: str | None = None,
        timeout_s: float = TIMEOUT_S,
    ) -> None:
        parts = urlsplit(url)
        self._server = parts.hostname or "", parts.port or _PORTS[parts.scheme]
        self._is_tls, self._starttls = parts.scheme == "smtps", starttls
        self._sender, self._to, self._earlier, self._zone = sender, tuple(to), earlier, zone
        self._login, self._page_url, self._timeout_s = login, page_url, timeout_s

    def deliver(self, event: Event, /) -> None:
        """Send a message if the event is new or worse than those before; see `Output`."""
        earlier = list(self._earlier(event))
        if is_told(event, earlier):
            message = message_of(event, earlier, self._zone, self._sender, self._to, self._page_url)
            with_server(lambda server: server.send_message(message), self._open, self._server[0])

    def look(self) -> str:
        """Sign in without sending anything; return what was found.

        Raises
        ------
        UndeliveredError
            When the server cannot be used.
        """
        with_server(lambda server: server.noop(), self._open, self._server[0])
        signed = "signed in" if self._login is not None else "without signing in"
        return f"{self._server[0]}:{self._server[1]} takes mail, {signed}"

    def _open(self) -> smtplib.SMTP:
        context = ssl.create_default_context()
        if self._is_tls:
            server: smtplib.SMTP = smtplib.SMTP_SSL(
                *self._server, timeout=self._timeout_s, context=context
            )
        else:
            server = smtplib.SMTP(*self._server, timeout=self._timeout_s)
        try:
            if self._starttls:
                server.starttls(context=context)
            if self._login is not None:
                server.login(self._login.user, self._login.password)
        except BaseException:
            server.close()
            raise
        return server


def with_server(
    do: Callable[[smtplib.SMTP], object], connect: Callable[[], smtplib.SMTP], host: str
) -> None:
    """Do something with a mail server; its words are not repeated, they may hold the password.

    Raises
    ------
    UndeliveredError
        When that fails.
    """
    try:
        with connect() as server:
            do(server)
    except smtplib.SMTPAuthenticationError as error:
        raise UndeliveredError(
            f"{host} refuses user and password (code {error.smtp_code})"
        ) from None
    except smtplib.SMTPRecipientsRefused as error:
        raise UndeliveredError(f"{host} refuses {', '.join(error.recipients)}") from None
    except smtplib.SMTPResponseException as error:
        raise UndeliveredError(f"{host} refuses the message (code {error.smtp_code})") from None
    except TimeoutError:
        raise UndeliveredError(f"{host} has not answered in time") from None
    except (OSError, smtplib.SMTPException) as error:
        said = error.strerror if isinstance(error, OSError) else None
        raise UndeliveredError(f"{host}: {said or type(error).__name__}") from None


def is_told(event: Event, earlier: Iterable[Event]) -> bool:
    """Tell whether somebody has to be told: it is new, or worse than all that came before.

    Examples
    --------
    >>> new = {"data": {"phase": "new", "severity": "warning"}}
    >>> worse = {"data": {"phase": "update", "severity": "alarm"}}
    >>> is_told(new, []), is_told(worse, [new]), is_told(worse, [new, worse])
    (True, True, False)
    """
    data = event["data"]
    if data["phase"] == "new":
        return True
    before = max((_rank(one) for one in earlier), default=-1)
    return data["phase"] == "update" and _rank(event) > before


def _rank(event: Event) -> int:
    return _SEVERITIES.index(event["data"]["severity"])


def message_of(
    event: Event,
    earlier: Sequence[Event],
    zone: tzinfo,
    sender: str,
    to: Sequence[str],
    page_url: str | None = None,
) -> EmailMessage:
    """Return the message about an event; the same event always has the same `Message-ID`.

    It says what happened, where and when, and nothing of who was there: mail passes through many
    hands.
    """
    data = event["data"]
    site = str(event["source"]).removeprefix("site/")
    message = EmailMessage()
    message["Subject"] = f"[{site}] {data['severity']}: {_what(data)}"
    message["From"], message["To"] = sender, ", ".join(to)
    message["Message-ID"] = _message_id(event)
    if earlier:
        message["In-Reply-To"] = message["References"] = _message_id(earlier[0])
    message["Auto-Submitted"] = "auto-generated"
    lines = [
        f"{_what(data)}.",
        "",
        f"Severity: {data['severity']}" + (" (it got worse)" if earlier else ""),
        f"Since: {_when(data['t_start_s'], zone)}",
        f"Rule: {data['rule']['id']} ({data['rule']['kind']})",
        f"Probability: {100.0 * data['probability']:.0f} %",
        f"People: {len(data['people'])}",
        *([f"Page: {page_url}"] if page_url else []),
        "",
        _ADVICE,
    ]
    message.set_content("\n".join(lines))
    return message


def _what(data: dict[str, Any]) -> str:
    """Return in a few words what happened, and where."""
    place = next((f"{k} {data[k]}" for k in ("zone", "line", "edge", "volume") if k in data), None)
    if "fault" in data:
        return str(data["fault"])
    expected = " expected" if data.get("predicted") else ""
    return f"{data['rule']['id']} ({data['rule']['kind']}){expected}" + (
        f" at {place}" if place else ""
    )


def _message_id(event: Event) -> str:
    site = str(event["source"]).removeprefix("site/")
    return f"<{event['id']}@{site}.trecsim>"


def _when(t_s: float, zone: tzinfo) -> str:
    if t_s < UNIX_FROM_S:
        return f"{t_s:.3f} s"
    return datetime.fromtimestamp(t_s, zone).strftime("%Y-%m-%d %H:%M:%S %Z")
