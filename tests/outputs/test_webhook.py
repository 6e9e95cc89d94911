"""Webhooks against a real HTTP receiver: signed, tried again until taken, never led elsewhere."""

import hashlib
import hmac
import json
from pathlib import Path

import pytest

from made_events import made_event
from receivers import Receiver, free_port, receiving, until
from trecsim.outputs.base import UndeliveredError
from trecsim.outputs.delivery import Delivery
from trecsim.outputs.webhook import Webhook
from trecsim.store.ledger import Ledger


def test_a_receiver_can_prove_who_sent_an_event_with_the_key_alone() -> None:
    with receiving(Receiver(free_port())) as receiver:
        Webhook(receiver.url, "a key").deliver(made_event())
    headers, body = receiver.taken[0]
    proof = hmac.new(b"a key", body, hashlib.sha256).hexdigest()
    assert headers["X-Trecsim-Signature"] == f"sha256={proof}"
    assert headers["Content-Type"] == "application/cloudevents+json"
    assert json.loads(body) == made_event()


def test_without_a_key_nothing_claims_to_be_signed() -> None:
    with receiving(Receiver(free_port())) as receiver:
        Webhook(receiver.url).deliver(made_event())
    assert "X-Trecsim-Signature" not in receiver.taken[0][0]


@pytest.mark.parametrize("status", [302, 400, 404, 429, 500, 503])
def test_any_answer_but_2xx_means_that_the_event_was_not_taken(status: int) -> None:
    with receiving(Receiver(free_port(), status)) as receiver:
        with pytest.raises(UndeliveredError, match=f"127.0.0.1 answers with status {status}"):
            Webhook(receiver.url).deliver(made_event())
        assert receiver.asked == 1


def test_a_receiver_that_hangs_or_is_not_there_is_told_and_not_waited_for_long() -> None:
    with (
        receiving(Receiver(free_port(), hangs=True)) as receiver,
        pytest.raises(UndeliveredError, match=r"has not answered within 0\.2 s"),
    ):
        Webhook(receiver.url, timeout_s=0.2).deliver(made_event())
    with pytest.raises(UndeliveredError, match=r"127\.0\.0\.1: Connection refused"):
        Webhook(receiver.url).deliver(made_event())


def test_a_receiver_that_was_away_answered_500_and_came_back_has_every_event_once(
    tmp_path: Path,
) -> None:
    receiver = Receiver(free_port())
    with Ledger(tmp_path) as ledger:
        hook = Webhook(receiver.url, "key", timeout_s=5.0)
        events = [made_event(f"episode {n}") for n in range(6)]
        with Delivery("desk", "webhook", lambda: hook, ledger, first_retry_s=0.02) as sending:
            with receiving(receiver):
                ledger.append_event(events[0])
                until(lambda: len(receiver.taken) == 1)
            for event in events[1:4]:  # nobody is there
                ledger.append_event(event)
            until(lambda: sending.health().fault is not None)
            receiver.status = 500
            with receiving(receiver):
                asked = receiver.asked
                until(lambda: receiver.asked > asked)
            receiver.status = 200
            with receiving(receiver):
                for event in events[4:]:
                    ledger.append_event(event)
                until(lambda: len(receiver.taken) >= 6)
    assert [json.loads(body)["id"] for _, body in receiver.taken] == [one["id"] for one in events]
