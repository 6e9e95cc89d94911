"""Feeds of a live site: files that grow, and what the recording keeps of them."""

import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from trecsim.safety.signals import Signal
from trecsim.service.live_signals import Followed, KeptSignals
from trecsim.sites.feed_files import kept_signals


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
    with Followed({"f": path}) as source:
        append(path, '{"t_s": 2, "grant": "a"}\n{"t_s"')
        first = waited(source, 1)
        append(path, ": 3}\n")
        second = waited(source, 1)
        assert source(51.0) == []
    assert [(one.t_s, one.taken_s) for one in first + second] == [(2.0, 50.0), (3.0, 50.0)]


def test_a_file_that_comes_later_or_begins_anew_is_read_from_its_beginning(tmp_path: Path) -> None:
    path = tmp_path / "f.jsonl"
    with Followed({"f": path}) as source:
        append(path, '{"t_s": 2}\n{"t_s": 3}\n')
        assert [one.t_s for one in waited(source, 2)] == [2.0, 3.0]
        path.write_text('{"t_s": 4}\n', encoding="utf-8")
        assert [one.t_s for one in waited(source, 1)] == [4.0]


def test_other_files_are_followed_from_then_on_and_one_that_stays_misses_nothing(
    tmp_path: Path,
) -> None:
    stays, goes, comes = (tmp_path / f"{name}.jsonl" for name in ("stays", "goes", "comes"))
    comes.write_text('{"t_s": 1}\n', encoding="utf-8")
    with Followed({}) as source:
        source.change({"s": stays, "g": goes})
        append(stays, '{"t_s": 2}\n')
        append(goes, '{"t_s": 3}\n')
        assert sorted((one.feed, one.t_s) for one in waited(source, 2)) == [("g", 3.0), ("s", 2.0)]
        append(stays, '{"t_s": 4}\n{"t_s"')
        source.change({"s": stays, "c": comes})
        append(stays, ": 5}\n")
        append(goes, '{"t_s": 6}\n')
        append(comes, '{"t_s": 7}\n')
        found = sorted((one.feed, one.t_s) for one in waited(source, 3))
    assert found == [("c", 7.0), ("s", 4.0), ("s", 5.0)]


def test_messages_are_kept_in_the_recording_as_the_rules_got_them(tmp_path: Path) -> None:
    given = [Signal("f", 4.0, "grant", "a", taken_s=4.5), Signal("f", 4.2, taken_s=4.5)]
    source = KeptSignals(lambda t_s: given if t_s == 4.5 else [])
    assert source(4.0) == []
    source.keep_in(tmp_path)
    assert source(4.5) == given
    assert kept_signals(tmp_path) == given
    (file,) = tmp_path.glob("signals-*.jsonl")
    assert file.stat().st_mode & 0o777 == 0o600  # who passed when is nobody else's business


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
