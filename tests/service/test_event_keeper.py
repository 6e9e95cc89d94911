"""Events on their way into the ledger and to viewers, with a disk that fails."""

from pathlib import Path
from threading import Event
from typing import Any

from made_page import until
from trecsim.errors import SetupError
from trecsim.service.event_keeper import EventKeeper
from trecsim.store.ledger import Ledger


class Disk:
    """A ledger whose disk can be full."""

    fault = None

    def __init__(self, folder: Path) -> None:
        self.ledger, self.is_full = Ledger(folder), False

    def append_event(self, event: Any) -> int:
        self._check()
        return self.ledger.append_event(event)

    def append_next(self, event: Any) -> Any:
        self._check()
        return self.ledger.append_next(event)

    def _check(self) -> None:
        if self.is_full:
            raise SetupError("no space left on device")

    def kept(self) -> list[Any]:
        return [one.event for one in self.ledger.events()]


class Told(list):
    def __call__(self, event: Any, kept: bool) -> None:
        self.append((event, kept))


def phase(name: str, episode: str = "e") -> dict[str, Any]:
    return {
        "type": "trecsim.camera.health.v1",
        "source": "site/hall",
        "data": {"event": episode, "phase": name, "t_start_s": 1.0},
    }


def test_an_event_is_in_the_ledger_before_it_is_told_and_acts_count(tmp_path: Path) -> None:
    disk, told, seen = Disk(tmp_path), Told(), []

    def tell(event: Any, kept: bool) -> None:
        seen.append(event in disk.kept())
        told(event, kept)

    with EventKeeper(disk, tell) as keeper:
        keeper.put(phase("new"))
        until(lambda: len(told) == 1)
        disk.ledger.act("e", "ack", "kim")
        keeper.put(phase("end"))
    assert seen == [True, True]
    assert [kept for _, kept in told] == [True, True]
    assert [(one["data"]["phase"], one["data"]["seq"]) for one in disk.kept()] == [
        ("new", 0), ("ack", 1), ("end", 2),
    ]  # fmt: skip


def test_on_a_full_disk_events_are_told_at_once_and_kept_later_each_once(tmp_path: Path) -> None:
    disk, told = Disk(tmp_path), Told()
    with EventKeeper(disk, told, retry_s=0.02) as keeper:
        disk.is_full = True
        keeper.put(phase("new"))
        keeper.put(phase("update"))
        until(lambda: len(told) == 2)
        assert keeper.fault == "no space left on device"
        assert disk.kept() == []
        disk.is_full = False
        until(lambda: keeper.fault is None)
        keeper.put(phase("end"))
    assert [kept for _, kept in told] == [False, False, True]
    assert disk.kept() == [event for event, _ in told]  # the very events that viewers got
    assert [one["data"]["seq"] for one in disk.kept()] == [0, 1, 2]


def test_events_outlive_a_disk_that_fills_up_while_they_come(tmp_path: Path) -> None:
    told = Told()
    with Ledger(tmp_path) as ledger:
        pages = ledger._connection.execute("PRAGMA page_count").fetchone()[0]
        ledger._connection.execute(f"PRAGMA max_page_count = {pages + 2}")
        with EventKeeper(ledger, told, retry_s=0.02) as keeper:
            for number in range(20):
                long = phase("new", f"e{number}")
                keeper.put({**long, "data": {**long["data"], "fault": "x" * 2000}})
            until(lambda: len(told) == 20)
            assert keeper.fault is not None
            assert "full" in keeper.fault
            assert 0 < ledger.count_events() < 20
            ledger._connection.execute("PRAGMA max_page_count = 100000")
            until(lambda: keeper.fault is None)
        assert [one.event for one in ledger.events()] == [event for event, _ in told]


def test_a_ledger_that_was_removed_is_told_before_the_next_event_comes(tmp_path: Path) -> None:
    told, aside = Told(), tmp_path / "aside"
    with Ledger(tmp_path / "site") as ledger, EventKeeper(ledger, told, retry_s=0.02) as keeper:
        assert keeper.fault is None
        (tmp_path / "site").rename(aside)
        assert keeper.fault is not None
        assert "it is not there any more" in keeper.fault
        keeper.put(phase("new"))
        until(lambda: len(told) == 1)
        assert [kept for _, kept in told] == [False]
        aside.rename(tmp_path / "site")
        until(lambda: keeper.fault is None)
        assert [one.event for one in ledger.events()] == [told[0][0]]


def test_the_end_of_an_episode_from_before_follows_what_was_there_even_on_a_full_disk(
    tmp_path: Path,
) -> None:
    disk, told = Disk(tmp_path), Told()
    before = disk.ledger.append_next(phase("new")).event
    disk.is_full = True
    with EventKeeper(disk, told, [before], retry_s=0.02) as keeper:
        keeper.acted(disk.ledger.act("e", "ack", "kim").event)
        keeper.put(phase("end"))
        until(lambda: len(told) == 1)
        disk.is_full = False
    assert [one["data"]["seq"] for one in disk.kept()] == [0, 1, 2]
    assert disk.kept()[-1]["data"]["phase"] == "end"


def test_who_puts_an_event_never_waits_for_the_disk() -> None:
    hangs, told = Event(), Told()

    class Hanging:
        fault = None

        def append_event(self, event: Any) -> int:
            raise NotImplementedError

        def append_next(self, event: Any) -> Any:
            hangs.wait()
            raise SetupError("the disk hung")

    with EventKeeper(Hanging(), told) as keeper:
        for _ in range(100):
            keeper.put(phase("new"))
        assert told == []
        hangs.set()
        until(lambda: len(told) == 100)
