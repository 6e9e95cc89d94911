"""The ledger: events, what people did to them, who reviewed them, and the audit log."""

import multiprocessing
import os
import signal
import sqlite3
import stat
import subprocess
import sys
import threading
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from trecsim.errors import InputError, SetupError
from trecsim.store import ledger as ledger_module
from trecsim.store.ledger import Ledger
from trecsim.store.ledger_file import NAME, VERSION, copy_ledger


def event(number: int = 0, phase: str = "new", t_s: float = 100.0, **data: Any) -> dict[str, Any]:
    """Return an event of the episode `e0` with a small evidence."""
    return {
        "specversion": "1.0",
        "type": "trecsim.zone.enter.v1",
        "id": f"id-{number}",
        "data": {
            "event": "e0",
            "phase": phase,
            "seq": number,
            "t_detect_s": t_s,
            "evidence": {"t_from_s": t_s - 5, "t_to_s": t_s + 5, "cameras": []},
            **data,
        },
    }


def test_events_come_back_as_they_were_and_in_order(tmp_path: Path) -> None:
    given = [event(0), event(1, "update", note="Zürich \u2028"), event(2, "end")]
    with Ledger(tmp_path) as ledger:
        numbers = [ledger.append_event(one) for one in given]
    with Ledger(tmp_path) as ledger:
        found = ledger.events()

    assert [one.event for one in found] == given
    assert [one.number for one in found] == numbers == sorted(set(numbers))


def test_an_event_that_is_sent_again_is_kept_once(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        assert ledger.append_event(event()) == ledger.append_event(event())
        assert len(ledger.events()) == 1


def test_the_next_event_of_an_episode_follows_what_people_did(tmp_path: Path) -> None:
    unnumbered = {"source": "site/hall", "data": {"event": "e0", "phase": "end", "t_end_s": 7.0}}
    with Ledger(tmp_path) as ledger:
        ledger.append_event(event(0))
        ledger.act("e0", "ack", "kim")
        made = ledger.append_next(unnumbered)
        assert made.event["data"]["seq"] == 2
        assert ledger.events()[-1] == made
        assert ledger.append_next(unnumbered).event["id"] != made.event["id"]


def test_episodes_without_an_end_are_found_with_their_newest_event(tmp_path: Path) -> None:
    zone, camera = "trecsim.zone.enter.v1", "trecsim.camera.health.v1"
    with Ledger(tmp_path) as ledger:
        for number, (episode, phase, kind) in enumerate(
            [
                ("a", "new", zone), ("b", "new", camera), ("c", "new", camera), ("d", "new", zone),
                ("a", "end", zone), ("b", "update", camera), ("c", "end", camera),
            ]
        ):  # fmt: skip
            one = event(number, phase)
            one["data"]["event"] = episode
            ledger.append_event({**one, "type": kind})
        ledger.act("c", "ack", "kim")
        ledger.act("d", "ack", "kim")

        def found(*types: str) -> list[tuple[str, str]]:
            data = [one.event["data"] for one in ledger.open_events(types)]
            return [(one["event"], one["phase"]) for one in data]

        assert found(camera) == [("b", "update")]
        assert found(zone, camera) == [("b", "update"), ("d", "ack")]
        assert found() == []


def test_events_are_found_after_a_number_by_time_and_by_episode(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        for number in range(6):
            one = event(number, t_s=100.0 + number)
            one["data"]["event"] = f"e{number % 2}"
            ledger.append_event(one)

        def ids(**which: Any) -> list[int]:
            return [one.event["data"]["seq"] for one in ledger.events(**which)]

        second = ledger.number_of("id-1")
        assert second is not None
        assert ids(after=second) == [2, 3, 4, 5]
        assert ids(from_s=101.0, until_s=103.0) == [1, 2, 3]
        assert ids(episode="e1") == [1, 3, 5]
        assert ids(limit=2) == [0, 1]
        assert ids(limit=2, newest=True) == [4, 5]


def test_what_is_no_event_is_refused(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        for wrong in ({"id": "x"}, {"data": {}}, event(probability=float("nan"))):
            with pytest.raises(InputError):
                ledger.append_event(wrong)
        assert ledger.events() == []


def test_an_act_becomes_an_event_and_an_entry_of_the_audit_log(tmp_path: Path) -> None:
    with Ledger(tmp_path, now=lambda: 1000.0) as ledger:
        ledger.append_event({**event(), "time": "2026-01-31T09:12:04.120Z"})
        ledger.act("e0", "shelve", "kim", until_s=1600.0, note="door held open")
        made = ledger.act("e0", "close", "kim", reason="expected").event

        assert made["data"]["phase"] == "close"
        assert made["data"]["seq"] == 2
        assert made["data"]["by"] == "kim"
        assert "until_s" not in made["data"]
        assert "note" not in made["data"]
        assert made["time"] == "1970-01-01T00:16:40.000Z"
        assert [one.event["id"] for one in ledger.events()][2] == made["id"] != "id-0"
        assert [(entry.who, entry.act) for entry in ledger.audit()] == [
            ("kim", "shelve"),
            ("kim", "close"),
        ]
        assert ledger.audit()[0].details == {
            "event": "e0",
            "until_s": 1600.0,
            "note": "door held open",
        }


def test_no_event_is_shelved_for_longer_than_a_shift(tmp_path: Path) -> None:
    with Ledger(tmp_path, now=lambda: 1000.0) as ledger:
        ledger.append_event(event())
        made = ledger.act("e0", "shelve", "kim", until_s=1e300).event
        assert (
            made["data"]["until_s"] == 1000.0 + 8 * 3600.0 == ledger.audit()[0].details["until_s"]
        )


@pytest.mark.parametrize(
    ("phase", "said", "told"),
    [
        ("shelve", {}, "until_s"),
        ("shelve", {"until_s": 5.0}, "until_s has passed"),
        ("ack", {"until_s": 5.0}, "until_s"),
        ("close", {}, "reason"),
        ("close", {"reason": "boring"}, "boring"),
        ("ack", {"reason": "true"}, "reason"),
        ("delete", {}, "delete"),
    ],
)
def test_an_act_that_is_not_complete_is_refused(
    tmp_path: Path, phase: Any, said: dict[str, Any], told: str
) -> None:
    with Ledger(tmp_path) as ledger:
        ledger.append_event(event())
        with pytest.raises(InputError, match=told):
            ledger.act("e0", phase, "kim", **said)
        assert len(ledger.events()) == 1
        assert ledger.audit() == []


def test_an_act_on_an_event_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger, pytest.raises(InputError, match="'e9'"):
        ledger.act("e9", "ack", "kim")


def test_reviewed_is_kept_per_user(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        ledger.mark_reviewed("kim", ["e0", "e1"])
        ledger.mark_reviewed("lee", ["e2"])
        ledger.mark_reviewed("kim", ["e0"], reviewed=False)

        assert ledger.reviewed("kim") == ["e1"]
        assert ledger.reviewed("lee") == ["e2"]


def test_a_user_cannot_fill_the_disk_with_what_was_reviewed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ledger_module, "MOST_REVIEWED", 3)
    times = iter(range(100))
    with Ledger(tmp_path, now=lambda: float(next(times))) as ledger:
        ledger.mark_reviewed("lee", ["other"])
        ledger.mark_reviewed("kim", ["e1", "e2"])
        ledger.mark_reviewed("kim", ["e3", "e4"])
        assert ledger.reviewed("kim") == ["e2", "e3", "e4"]
        assert ledger.reviewed("lee") == ["other"]


@pytest.mark.parametrize(
    "change",
    [
        "UPDATE audit SET who = 'lee' WHERE number = 3",
        "UPDATE audit SET details = '{}' WHERE number = 3",
        "UPDATE audit SET t_s = 1 WHERE number = 3",
        "UPDATE audit SET details = '{' WHERE number = 3",
        "UPDATE audit SET t_s = 9e999 WHERE number = 3",
        "UPDATE audit SET hash = x'00ff' WHERE number = 3",
        "UPDATE audit SET who = x'ff00' WHERE number = 3",
        "DELETE FROM audit WHERE number = 3",
        "DELETE FROM audit WHERE number = 3; UPDATE audit SET number = number - 1 WHERE number > 3",
    ],
)
def test_a_changed_entry_of_the_audit_log_is_found(tmp_path: Path, change: str) -> None:
    with Ledger(tmp_path) as ledger:
        for number in range(5):
            ledger.append_audit("kim", "login", {"from": f"10.0.0.{number}"})
        whole = ledger.verify_audit()
        assert (whole.is_whole, whole.entries) == (True, 5)
        with closing(sqlite3.connect(tmp_path / NAME)) as intruder:
            intruder.executescript(change)

        assert ledger.verify_audit().broken_at == 3
        assert not ledger.verify_audit().is_whole


def test_a_ledger_is_for_its_owner_alone(tmp_path: Path) -> None:
    with Ledger(tmp_path / "data") as ledger:
        ledger.append_event(event())
        modes = {stat.S_IMODE(path.stat().st_mode) for path in (tmp_path / "data").iterdir()}

    assert modes == {0o600}
    assert stat.S_IMODE((tmp_path / "data").stat().st_mode) == 0o700


def write_many(folder: Path, name: str) -> None:
    with Ledger(folder) as ledger:
        for number in range(50):
            one = event()
            ledger.append_event({**one, "id": f"{name}-{number}"})
            ledger.append_audit(name, "test")


def test_several_processes_and_threads_write_at_the_same_time(tmp_path: Path) -> None:
    Ledger(tmp_path).close()
    context = multiprocessing.get_context("spawn")
    others = [context.Process(target=write_many, args=(tmp_path, name)) for name in "ab"]
    for other in others:
        other.start()
    with Ledger(tmp_path) as ledger:
        threads = [
            threading.Thread(target=ledger.append_audit, args=(f"thread {n}", "test"))
            for n in range(20)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for other in others:
            other.join()

        assert [other.exitcode for other in others] == [0, 0]
        assert len(ledger.events()) == 100
        verdict = ledger.verify_audit()
        assert (verdict.is_whole, verdict.entries) == (True, 120)


ENDLESS = """
import sys
from pathlib import Path
sys.path[:0] = sys.argv[2:]
from trecsim.store.ledger import Ledger
ledger = Ledger(Path(sys.argv[1]))
number = 0
while True:
    ledger.append_event({"id": str(number), "data": {"event": "e"}})
    ledger.append_audit("kim", "test", {"number": number})
    print(number, flush=True)
    number += 1
"""


def test_a_kill_loses_nothing_that_was_acknowledged(tmp_path: Path) -> None:
    command = [sys.executable, "-c", ENDLESS, str(tmp_path), *sys.path]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        said = [int(process.stdout.readline()) for _ in range(40)]
        os.kill(process.pid, signal.SIGKILL)
        said += [int(line) for line in process.stdout.read().split("\n") if line]
    with Ledger(tmp_path) as ledger:
        kept = [int(one.event["id"]) for one in ledger.events()]

        assert kept[: len(said)] == said
        assert ledger.verify_audit().is_whole


def test_a_damaged_ledger_is_moved_aside_and_a_new_one_begun(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with Ledger(tmp_path) as ledger:
        for number in range(300):
            ledger.append_event({**event(), "id": str(number)})
    content = bytearray((tmp_path / NAME).read_bytes())
    content[8192 : 8192 + 4096] = bytes(range(256)) * 16
    (tmp_path / NAME).write_bytes(content)

    with Ledger(tmp_path) as ledger:
        assert ledger.events() == []
        ledger.append_event(event())
    (aside,) = tmp_path.glob(f"{NAME}.damaged-*")
    assert aside.read_bytes() == bytes(content)
    assert aside.name in caplog.text
    assert len(caplog.records) == 1


def test_the_page_does_not_move_a_damaged_ledger(tmp_path: Path) -> None:
    (tmp_path / NAME).write_bytes(b"this is no database, but long enough to look like one" * 99)

    with pytest.raises(InputError, match="damaged"):
        Ledger(tmp_path, repair=False)
    assert [path.name for path in tmp_path.iterdir()] == [NAME]


@pytest.mark.parametrize("body", ["{", "[]", '{"id": "e1-0"}', "x'00ff'"])
def test_an_event_whose_text_is_damaged_is_left_out_and_all_others_stay(
    tmp_path: Path, body: str
) -> None:
    with Ledger(tmp_path) as ledger:
        ledger.append_event(event(1, event="e1"))
        ledger.append_event(event(2, event="e2"))
        with closing(sqlite3.connect(tmp_path / NAME)) as intruder:
            intruder.execute("UPDATE event SET body = ? WHERE episode = 'e1'", [body])
            intruder.commit()

        (left,) = ledger.events()
        assert left.event["data"]["event"] == "e2"
        assert [one.number for one in ledger.open_events([left.event["type"]])] == [left.number]


def test_a_ledger_of_a_newer_version_is_refused_and_stays(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        ledger.append_event(event())
    with closing(sqlite3.connect(tmp_path / NAME)) as newer:
        newer.execute(f"PRAGMA user_version = {VERSION + 1}")

    with pytest.raises(InputError, match=f"version {VERSION + 1}.*newer"):
        Ledger(tmp_path)
    assert not list(tmp_path.glob("*damaged*"))


def test_a_database_of_another_program_is_refused_and_stays(tmp_path: Path) -> None:
    with closing(sqlite3.connect(tmp_path / NAME)) as other:
        other.execute("CREATE TABLE bookmarks (url TEXT)")

    with pytest.raises(InputError, match="another kind"):
        Ledger(tmp_path)
    assert not list(tmp_path.glob("*damaged*"))


def test_nothing_is_written_into_a_file_that_was_removed_or_replaced(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        ledger.append_event(event())
        (tmp_path / NAME).unlink()
        with pytest.raises(SetupError, match=r"it is not there any more .* start the site again"):
            ledger.act("e0", "ack", "kim")
        assert [one.event["data"]["phase"] for one in ledger.events()] == ["new"]
        (tmp_path / NAME).touch()
        with pytest.raises(SetupError, match="another file took its place"):
            ledger.append_event(event(1))


def test_old_episodes_are_forgotten_as_a_whole(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        for number, (episode, t_s) in enumerate([("old", 10), ("long", 10), ("long", 90)]):
            one = event(number, t_s=t_s)
            one["data"]["event"] = episode
            ledger.append_event(one)
        ledger.mark_reviewed("kim", ["old", "long"])

        assert ledger.forget_events(50.0) == 1
        assert [one.event["data"]["event"] for one in ledger.events()] == ["long", "long"]
        assert ledger.reviewed("kim") == ["long"]


def test_evidence_spans_all_events_of_an_episode(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        ledger.append_event(event(0, t_s=100.0))
        ledger.append_event(event(1, "end", t_s=130.0))

        assert ledger.evidence() == [(95.0, 135.0)]


def test_a_copy_of_a_ledger_in_use_is_whole(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        ledger.append_event(event())
        ledger.append_audit("kim", "login")
        copy_ledger(ledger.path, tmp_path / "copy.sqlite")
    (tmp_path / "other").mkdir()
    (tmp_path / "copy.sqlite").rename(tmp_path / "other" / NAME)
    with Ledger(tmp_path / "other") as copy:
        assert len(copy.events()) == 1
        assert copy.verify_audit().entries == 1


def test_a_folder_that_cannot_be_written_is_told_in_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")

    with pytest.raises((InputError, SetupError), match="file"):
        Ledger(tmp_path / "file" / "data")


def raised(severity: str, seq: int) -> dict[str, Any]:
    made = event(seq, "update" if seq else "new")
    return {**made, "data": {**made["data"], "event": "e0", "severity": severity}}


def test_an_event_is_acknowledged_once_until_it_becomes_more_severe(tmp_path: Path) -> None:
    with Ledger(tmp_path) as ledger:
        ledger.append_event(raised("warning", 0))
        ledger.act("e0", "ack", "kim")
        ledger.append_event(raised("warning", 5))
        with pytest.raises(InputError, match="was acknowledged before, by kim"):
            ledger.act("e0", "ack", "lee")
        ledger.append_event(raised("alarm", 6))
        ledger.act("e0", "ack", "lee")
        assert [entry.who for entry in ledger.audit()] == ["kim", "lee"]


def test_only_what_is_shelved_is_unshelved(tmp_path: Path) -> None:
    now_s = 1000.0
    with Ledger(tmp_path, now=lambda: now_s) as ledger:
        ledger.append_event(raised("warning", 0))
        with pytest.raises(InputError, match="is not shelved"):
            ledger.act("e0", "unshelve", "kim")
        ledger.act("e0", "shelve", "kim", until_s=1100.0)
        ledger.act("e0", "unshelve", "kim")
        with pytest.raises(InputError, match="is not shelved"):
            ledger.act("e0", "unshelve", "kim")
        ledger.act("e0", "shelve", "kim", until_s=1200.0)
        now_s = 1300.0  # its time is over
        with pytest.raises(InputError, match="is not shelved"):
            ledger.act("e0", "unshelve", "kim")
