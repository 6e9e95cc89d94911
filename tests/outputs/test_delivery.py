"""Delivery of events: nothing is lost, nothing is told as two events, nobody waits."""

import logging
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from made_events import made_event
from receivers import until
from trecsim.outputs.base import Event, UndeliveredError
from trecsim.outputs.delivery import Delivery
from trecsim.store.ledger import Ledger


class Taking:
    """An output that takes events, unless it is told not to."""

    def __init__(self) -> None:
        self.taken: list[str] = []
        self.tried: list[str] = []
        self.fault: Exception | None = None

    def deliver(self, event: Event, /) -> None:
        self.tried.append(event["id"])
        if self.fault is not None:
            raise self.fault
        self.taken.append(event["id"])


def delivery(ledger: Ledger, output: Any, **options: Any) -> Delivery:
    return Delivery("desk", "webhook", lambda: output, ledger, first_retry_s=0.02, **options)


def put(ledger: Ledger, *names: str) -> list[str]:
    events = [made_event(name) for name in names]
    for event in events:
        ledger.append_event(event)
    return [event["id"] for event in events]


def test_an_output_gets_what_comes_from_its_start_on_and_in_order(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        put(ledger, "before")
        output = Taking()
        with delivery(ledger, output) as sending:
            ids = put(ledger, "a", "b", "c")
            sending.look()
            until(lambda: output.taken == ids)
            assert sending.health().queue == 0


def test_events_wait_in_order_until_they_are_taken(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with Ledger(tmp_path) as ledger:
        output = Taking()
        output.fault = UndeliveredError("nobody is there")
        with delivery(ledger, output) as sending:
            ids = put(ledger, "a", "b")
            until(lambda: len(output.tried) >= 3)
            health = sending.health()
            assert (health.queue, health.fault, health.delivered) == (2, "nobody is there", 0)
            assert set(output.tried) == {ids[0]}
            output.fault = None
            until(lambda: output.taken == ids)
            until(lambda: sending.health().fault is None)
    told = [record.getMessage() for record in caplog.records]
    assert told == [
        "output desk: nobody is there; its events are kept and tried again",
        "output desk delivers again",
    ]


def test_after_a_new_start_the_rest_is_delivered_and_nothing_twice(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger, delivery(ledger, first := Taking()) as sending:
        done = put(ledger, "a", "b")
        sending.look()
        until(lambda: first.taken == done)
    with Ledger(tmp_path) as ledger:
        rest = put(ledger, "c", "d")
        with delivery(ledger, second := Taking()):
            until(lambda: second.taken == rest)


def test_what_is_left_at_the_end_is_delivered_before_it(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        output = Taking()
        with delivery(ledger, output):
            ids = put(ledger, *(f"event {n}" for n in range(300)))
        assert output.taken == ids


def test_an_output_that_hangs_delays_neither_others_nor_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("trecsim.outputs.delivery.ENDING_S", 0.1)
    release = threading.Event()

    class Hanging:
        def deliver(self, event: Event, /) -> None:
            release.wait()

    with Ledger(tmp_path) as ledger:
        output = Taking()
        hanging = Delivery("slow", "webhook", Hanging, ledger, clock=iter(range(10**6)).__next__)
        with hanging, delivery(ledger, output):
            ids = put(ledger, "a", "b")
            until(lambda: output.taken == ids)
            until(lambda: (hanging.health().waiting_s or 0.0) > 10.0)
            assert hanging.health().state == "waiting"
            assert hanging.health().said("slow") is not None
        release.set()
        until(lambda: not any(one.name == "output-slow" for one in threading.enumerate()))


def test_events_that_an_output_does_not_want_are_passed_over(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        output = Taking()
        wanted: Callable[[Event], bool] = lambda event: event["data"]["event"] != "b"  # noqa: E731
        with delivery(ledger, output, wanted=wanted) as sending:
            a, _, c = put(ledger, "a", "b", "c")
            until(lambda: output.taken == [a, c])
            until(lambda: sending.health().queue == 0)


def test_a_fault_of_the_program_is_told_without_its_text(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with Ledger(tmp_path) as ledger:
        output = Taking()
        output.fault = ValueError("s3cret")
        with caplog.at_level(logging.DEBUG), delivery(ledger, output) as sending:
            put(ledger, "a")
            until(lambda: sending.health().fault is not None)
            assert str(sending.health().fault).startswith("ValueError at test_delivery.py:")
    assert "s3cret" not in caplog.text


KILLED = """
import sys, os, signal
from pathlib import Path
from trecsim.outputs.delivery import Delivery
from trecsim.outputs.json_lines import JsonLines
from trecsim.store.ledger import Ledger

folder, stop_at = Path(sys.argv[1]), int(sys.argv[2])
count = 0

class Killing(JsonLines):
    def deliver(self, event, /):
        global count
        super().deliver(event)
        count += 1
        if count == stop_at:
            os.kill(os.getpid(), signal.SIGKILL)

ledger = Ledger(folder)
with Delivery("file", "jsonl", lambda: Killing(folder / "events.jsonl"), ledger):
    pass
"""


def test_a_file_holds_each_event_once_though_the_process_is_killed_again_and_again(
    tmp_path: Path,
) -> None:
    with Ledger(tmp_path) as ledger:
        ledger.cursor("file")
        ids = put(ledger, *(f"event {n}" for n in range(12)))
    for stop_at in (1, 3, 4):
        ran = subprocess.run(
            [sys.executable, "-c", KILLED, str(tmp_path), str(stop_at)],
            capture_output=True, check=False, timeout=120,
        )  # fmt: skip
        assert ran.returncode == -9, ran.stderr
    with (tmp_path / "events.jsonl").open("a") as file:
        file.write('{"id": "torn')
    ran = subprocess.run(
        [sys.executable, "-c", KILLED, str(tmp_path), "-1"],
        capture_output=True, check=False, timeout=120,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr
    import json

    lines = (tmp_path / "events.jsonl").read_text().splitlines()
    assert [json.loads(line)["id"] for line in lines] == ids
