"""Feeds of a live site: files that grow, posted messages, and what the recording keeps of them."""

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from trecsim.errors import ConfigError
from trecsim.safety.signals import Signal
from trecsim.service.live_feeds import LiveFeeds
from trecsim.service.live_signals import KeptSignals
from trecsim.service.waiting_lines import LEAST_LINES, MOST_BYTES, WaitingLines
from trecsim.sites.feed_files import LONGEST_LINE, kept_signals, signals_of
from trecsim.sites.feed_tables import FeedTable


def append(path: Path, text: str) -> None:
    with path.open("a", encoding="utf-8") as file:
        file.write(text)


def waited(source: Callable[[float], list[Signal]], count: int) -> list[Signal]:
    found: list[Signal] = []
    ends_s = time.monotonic() + 10.0
    while len(found) < count and time.monotonic() < ends_s:
        found += source(50.0)
        threading.Event().wait(0.01)
    return found


def test_lines_that_are_appended_come_once_and_those_from_before_do_not(tmp_path: Path) -> None:
    path = tmp_path / "f.jsonl"
    path.write_text('{"t_s": 1}\n', encoding="utf-8")
    with LiveFeeds({"f": FeedTable(file=path)}) as source:
        append(path, '{"t_s": 2, "grant": "a"}\n{"t_s"')
        first = waited(source, 1)
        append(path, ": 3}\n")
        second = waited(source, 1)
        assert source(51.0) == []
    assert [(one.t_s, one.taken_s) for one in first + second] == [(2.0, 50.0), (3.0, 50.0)]


def test_a_file_that_comes_later_or_begins_anew_is_read_from_its_beginning(tmp_path: Path) -> None:
    path = tmp_path / "f.jsonl"
    with LiveFeeds({"f": FeedTable(file=path)}) as source:
        append(path, '{"t_s": 2}\n{"t_s": 3}\n')
        assert [one.t_s for one in waited(source, 2)] == [2.0, 3.0]
        path.write_text('{"t_s": 4}\n', encoding="utf-8")
        assert [one.t_s for one in waited(source, 1)] == [4.0]


def test_other_files_are_followed_from_then_on_and_one_that_stays_misses_nothing(
    tmp_path: Path,
) -> None:
    stays, goes, comes = (tmp_path / f"{name}.jsonl" for name in ("stays", "goes", "comes"))
    comes.write_text('{"t_s": 1}\n', encoding="utf-8")
    with LiveFeeds({}) as source:
        source.change({"s": FeedTable(file=stays), "g": FeedTable(file=goes)})
        append(stays, '{"t_s": 2}\n')
        append(goes, '{"t_s": 3}\n')
        assert sorted((one.feed, one.t_s) for one in waited(source, 2)) == [("g", 3.0), ("s", 2.0)]
        append(stays, '{"t_s": 4}\n{"t_s"')
        source.change({"s": FeedTable(file=stays), "c": FeedTable(file=comes)})
        append(stays, ": 5}\n")
        append(goes, '{"t_s": 6}\n')
        append(comes, '{"t_s": 7}\n')
        found = sorted((one.feed, one.t_s) for one in waited(source, 3))
    assert found == [("c", 7.0), ("s", 4.0), ("s", 5.0)]


def test_what_changes_after_the_end_is_not_followed_any_more(tmp_path: Path) -> None:
    """The site file may be read again until all else has ended, too."""
    subscribed: list[str] = []

    def subscribe(name: str, *given: Any) -> Any:
        subscribed.append(name)
        raise ConfigError("no broker")

    topic = FeedTable(mqtt="hall/tickets")
    with LiveFeeds({"t": topic}, subscribe) as source:
        assert subscribed == ["t"]
    source.change({"other": topic, "f": FeedTable(file=tmp_path / "f.jsonl")})
    assert subscribed == ["t"]
    assert "feeds" not in {one.name for one in threading.enumerate()}


def test_posted_messages_come_once_and_only_where_the_site_file_allows_that(
    tmp_path: Path,
) -> None:
    feeds = {"posted": FeedTable(http=True), "written": FeedTable(file=tmp_path / "f.jsonl")}
    source = LiveFeeds(feeds)
    for name in ("posted", "written", "unknown"):
        source.put(name, [b'{"t_s": 2, "grant": "a"}', b"{"])
    found = source(5.0)
    assert [(one.feed, one.what, one.taken_s) for one in found] == [
        ("posted", "grant", 5.0), ("posted", "unreadable", 5.0),
    ]  # fmt: skip
    assert source(6.0) == []
    source.put("posted", [b'{"t_s": 3}'])
    source.change({"posted": FeedTable(http=True, silent_s=5.0)})
    assert [one.t_s for one in source(7.0)] == [3.0]  # what waited is not lost
    source.change({"posted": FeedTable(file=tmp_path / "f.jsonl")})
    source.put("posted", [b'{"t_s": 4}'])
    assert source(8.0) == []


def test_a_flood_takes_bounded_memory_and_says_what_it_lost() -> None:
    now_s = [0.0]
    waiting = WaitingLines(100.0, lambda: now_s[0])
    waiting.put(b"%d" % n for n in range(LEAST_LINES + 500))
    lines, dropped = waiting.take()
    assert (len(lines), dropped) == (LEAST_LINES, 500)
    now_s[0] = 1.0  # twice the limit of the feed is taken in the long run
    waiting.put(b"%d" % n for n in range(1000))
    assert [len(waiting.take()[0]), waiting.take()[1]] == [200, 0]
    for _ in range(20):  # nobody takes: the newest stay
        now_s[0] += 1.0
        waiting.put(b"%d at %g" % (n, now_s[0]) for n in range(100))
    lines, dropped = waiting.take()
    assert (len(lines), dropped, lines[-1]) == (LEAST_LINES, 1000, b"99 at 21")


def test_long_messages_take_bounded_memory_and_stay_too_long() -> None:
    waiting = WaitingLines(10_000.0)
    waiting.put(b"x" * 60_000 for _ in range(3000))
    lines, dropped = waiting.take()
    assert {len(line) for line in lines} == {LONGEST_LINE + 1}
    assert sum(map(len, lines)) <= MOST_BYTES
    assert len(lines) + dropped == 3000


def test_a_feed_that_floods_is_distrusted() -> None:
    source = LiveFeeds({"f": FeedTable(http=True)})
    source.put("f", [b'{"t_s": 2}'] * (LEAST_LINES + 1))
    first, *others = source(5.0)
    assert (first.what, first.note) == (
        "unreadable", "1 messages were dropped: too many came at once",
    )  # fmt: skip
    assert {one.what for one in others} == {"alive"}


def test_messages_are_kept_in_the_recording_as_the_rules_got_them(tmp_path: Path) -> None:
    given = [Signal("f", 4.0, "grant", "a", taken_s=4.5), Signal("f", 4.2, taken_s=4.5)]
    source = KeptSignals(lambda t_s: given if t_s == 4.5 else [])
    assert source(4.0) == []
    source.keep_in(tmp_path)
    assert source(4.5) == given
    assert kept_signals(tmp_path) == given
    (file,) = tmp_path.glob("signals-*.jsonl")
    assert file.stat().st_mode & 0o777 == 0o600  # who passed when is nobody else's business


def test_the_recording_of_a_site_with_feeds_tells_that_no_message_came(tmp_path: Path) -> None:
    (tmp_path / "f.jsonl").write_text('{"t_s": 3}\n', encoding="utf-8")
    feeds = {"f": FeedTable(file=tmp_path / "f.jsonl")}
    source = KeptSignals(lambda t_s: [])
    source.keep_in(tmp_path)  # a site without feeds: somebody may give it some afterwards
    assert len(signals_of(feeds, tmp_path)) == 1
    source.keep_in(tmp_path, 7300.0)
    assert signals_of(feeds, tmp_path) == []
    assert (tmp_path / "signals-0000000002.jsonl").exists()


def test_what_a_crash_left_of_a_message_harms_no_later_one(tmp_path: Path) -> None:
    """A line in the middle of which another begins would make all of the recording unreadable."""
    given = [Signal("f", 4.0, "grant", "a" * 60, taken_s=4.5)]
    source = KeptSignals(lambda t_s: given)
    source.keep_in(tmp_path)
    for _ in range(300):
        source(4.5)
    (file,) = tmp_path.glob("signals-*.jsonl")
    content = file.read_bytes()
    for left in (b'{"feed": "f", "taken', content[:-1]):
        file.write_bytes(content[: -len(content) // 300] + left)
        source(4.5)
        assert set(kept_signals(tmp_path)) == set(given)
        assert file.read_bytes().endswith(b"\n")


def test_a_recording_that_cannot_be_written_keeps_no_message_from_the_rules(
    tmp_path: Path,
) -> None:
    given = [Signal("f", 4.0, taken_s=4.5)]
    source = KeptSignals(lambda t_s: given)
    source.keep_in(tmp_path / "gone")
    assert source(4.5) == source(4.6) == given


def test_a_place_that_the_site_does_not_have_is_logged_once_with_the_nearest_name(
    caplog: pytest.LogCaptureFixture,
) -> None:
    given = [Signal("f", 4.0, "grant", "gata"), Signal("f", 4.1, "grant", "gate")]
    lines = {"gate": 1}
    source = KeptSignals(lambda t_s: given, lambda: (lines, ()))
    assert source(4.5) == source(4.6) == given
    (told,) = caplog.messages
    assert "feed f tells of line 'gata'" in told
    assert "gate" in told.partition(";")[2]
    del lines["gate"]  # a site file that was changed meanwhile
    source(4.7)
    assert len(caplog.messages) == 3
