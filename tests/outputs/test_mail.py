"""Mail against a real SMTP server: one message per happening, one more when it gets worse."""

from collections.abc import Iterator
from email import message_from_bytes
from email.message import Message
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

import pytest

from made_events import made_event
from receivers import free_port, until
from trecsim.outputs.base import UndeliveredError
from trecsim.outputs.delivery import Delivery
from trecsim.outputs.mail import Mail
from trecsim.outputs.opening import _earlier
from trecsim.sources.streams.camera_login import Login
from trecsim.store.ledger import Ledger

controller = pytest.importorskip("aiosmtpd.controller")

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


class Postbox:
    """A mail server and what it has taken."""

    def __init__(self, **options: Any) -> None:
        self.messages: list[Message] = []
        self.refuses = False
        self._server = controller.Controller(self, "127.0.0.1", free_port(), **options)
        self._server.start()

    @property
    def url(self) -> str:
        return f"smtp://127.0.0.1:{self._server.port}"

    async def handle_DATA(self, server: Any, session: Any, envelope: Any) -> str:
        if self.refuses:
            return "451 try again"
        self.messages.append(message_from_bytes(envelope.content))
        return "250 OK"

    def stop(self) -> None:
        self._server.stop()


@pytest.fixture
def postbox() -> Iterator[Postbox]:
    box = Postbox()
    yield box
    box.stop()


def mail(url: str, earlier: Any = lambda event: (), **options: Any) -> Mail:
    zone = ZoneInfo("Europe/Zurich")
    return Mail(url, "trecsim@hall.example", ["kim@hall.example"], earlier, zone, **options)


def test_one_message_tells_of_a_happening_and_one_more_that_it_got_worse(
    tmp_path: Path, postbox: Postbox
) -> None:
    with Ledger(tmp_path) as ledger:
        output = mail(postbox.url, lambda event: _earlier(ledger, event))
        told = [
            made_event(),
            made_event(phase="update", seq=1, predicted=False),
            made_event(phase="update", seq=2, severity="alarm"),
            made_event(phase="ack", seq=3, severity="alarm", by="kim"),
            made_event(phase="update", seq=4, severity="alarm"),
            made_event(phase="end", seq=5, severity="alarm"),
        ]
        with Delivery("mail", "mail", lambda: output, ledger, first_retry_s=0.02) as sending:
            for event in told:
                ledger.append_event(event)
            until(lambda: sending.health().queue == 0)
    first, second = postbox.messages
    assert first["Subject"] == "[hall] warning: strip (zone.enter) at zone exit-strip"
    assert second["Subject"] == "[hall] alarm: strip (zone.enter) at zone exit-strip"
    assert second["In-Reply-To"] == first["Message-ID"]
    text = first.get_payload()
    assert "Since: 2023-11-14 23:13:20 CET" in text
    assert "no certified safety function" in text
    assert "floor_m" not in text


def test_a_message_that_is_sent_again_is_the_same_message(postbox: Postbox) -> None:
    output = mail(postbox.url)
    postbox.refuses = True
    with pytest.raises(UndeliveredError, match=r"refuses the message \(code 451\)"):
        output.deliver(made_event())
    postbox.refuses = False
    output.deliver(made_event())
    output.deliver(made_event())
    assert len({one["Message-ID"] for one in postbox.messages}) == 1


def test_a_mail_server_that_is_away_is_told(postbox: Postbox) -> None:
    postbox.stop()
    with pytest.raises(UndeliveredError, match=r"127\.0\.0\.1: Connection refused"):
        mail(postbox.url).deliver(made_event())
    postbox.__init__()  # type: ignore[misc]  # for the end of the fixture


def test_a_server_that_does_not_take_the_password_is_told_without_it(postbox: Postbox) -> None:
    output = mail(postbox.url, login=Login("kim", "s3cret"))
    with pytest.raises(UndeliveredError) as caught:
        output.look()
    assert "s3cret" not in str(caught.value)
    assert "takes mail, without signing in" in mail(postbox.url).look()
