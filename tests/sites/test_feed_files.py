"""Messages of feeds: lines of JSON, files, and what a recording keeps of them."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from trecsim.errors import InputError
from trecsim.safety.signals import Signal
from trecsim.sites.feed_files import (
    LONGEST_LINE,
    _bounded,
    kept_between,
    kept_signals,
    line_of,
    read_feed,
    recorded_signal,
    signal_of,
    signals_of,
)
from trecsim.sites.feed_remarks import name_remarks
from trecsim.sites.feed_tables import FeedTable

GOOD = {
    '{"t_s": 1}': Signal("f", 1.0),
    '{"t_s": 1.5, "grant": "left"}': Signal("f", 1.5, "grant", "left"),
    '{"t_s": 1.5, "grant": "left", "people": 3}': Signal("f", 1.5, "grant", "left", people=3),
    '{"t_s": 1.5, "closed": "left"}': Signal("f", 1.5, "closed", "left"),
    '{"t_s": 1.5, "volume": "cart", "xy_m": [1, 2.5]}': Signal(
        "f", 1.5, "volume", "cart", xy_m=(1.0, 2.5)
    ),
    '{"t_s": 1.5, "volume": "cart", "id": "7", "xy_m": [1, 2], "heading_deg": 90}': Signal(
        "f", 1.5, "volume", "cart", vehicle="7", xy_m=(1.0, 2.0), heading_rad=math.pi / 2
    ),
    '{"t_s": 1.5, "volume": "cart", "id": "7", "gone": true}': Signal(
        "f", 1.5, "gone", "cart", vehicle="7"
    ),
}


def same(one: Signal, other: Signal) -> bool:
    def known(signal: Signal) -> Signal:
        return signal if signal.taken_s == signal.taken_s else replace(signal, taken_s=-1.0)

    return known(one) == known(other)


@pytest.mark.parametrize("line", GOOD)
def test_a_message_is_read_and_comes_back_from_a_recording(line: str) -> None:
    signal = signal_of("f", line)
    assert same(signal, GOOD[line])
    taken = replace(signal, taken_s=9.25)
    assert recorded_signal(line_of(taken).encode()) == taken


@pytest.mark.parametrize(
    ("line", "note"),
    [
        ("{", "a message is no JSON"),
        ("[" * 4000, "a message is no JSON"),
        ("[1]", "a message is no object"),
        ("{}", "expected t_s as a number of at most 1e+11, found None"),
        ('{"t_s": true}', "expected t_s as a number of at most 1e+11, found True"),
        ('{"t_s": NaN}', "expected t_s as a number of at most 1e+11, found nan"),
        ('{"t_s": 1, "grant": 5}', "expected grant as the name of a place, found 5"),
        ('{"t_s": 1, "grnat": "a"}', "unknown key 'grnat' in a message"),
        ('{"t_s": 1, "grant": "a", "people": 0}', "expected people from 1 to 1000, found 0"),
        (
            '{"t_s": 1, "grant": "a", "closed": "a"}',
            "expected one of grant, closed and volume, found grant and closed",
        ),
        ('{"t_s": 1, "volume": "a", "xy_m": [1]}', "expected xy_m = [x, y] of a volume"),
        (
            '{"t_s": 1, "volume": "a", "xy_m": [1, "b"]}',
            "expected xy_m as a number of at most 10000, found 'b'",
        ),
        (
            '{"t_s": 1, "grant": "a\\u001b[31m"}',
            "expected grant as the name of a place, found 'a\\x1b[31m'",
        ),
        (
            '{"t_s": 1, "volume": "a", "id": "\\ud800", "xy_m": [1, 2]}',
            "expected id as a number or up to 64 letters, found '\\ud800'",
        ),
        (
            '{"t_s": 1, "volume": "a", "id": "' + "\u00fc" * 1500 + '", "xy_m": [1, 2]}',
            "expected id as a number or up to 64 letters, found '" + "\u00fc" * 39,
        ),
        (
            '{"t_s": 1, "volume": "a", "xy_m": [1, 2], "gone": "yes"}',
            "expected gone as true or false, found 'yes'",
        ),
        (
            '{"t_s": 1, "' + "\u200b" * 1300 + '": 1}',
            "unknown key '" + "\\u200b" * 6 + "\\u2 in a message",
        ),
        ('{"t_s": 1, "grant": "' + "a" * 5000 + '"}', "a message is longer than 4096 bytes"),
    ],
)
def test_a_message_that_is_wrong_says_what_is_wrong_and_is_kept_as_such(
    line: str, note: str
) -> None:
    signal = signal_of("f", line, known_s=7.0)
    assert (signal.what, signal.t_s, signal.note) == ("unreadable", 7.0, note)
    taken = replace(signal, taken_s=8.0)
    assert recorded_signal(line_of(taken).encode()) == taken


def test_a_file_is_read_line_by_line_and_a_wrong_line_stands_at_the_time_before_it(
    tmp_path: Path,
) -> None:
    path = tmp_path / "f.jsonl"
    path.write_text('{"t_s": 3}\n\noops\n{"t_s": 4, "grant": "a"}\n', encoding="utf-8")
    assert [(one.t_s, one.what) for one in read_feed("f", path)] == [
        (3.0, "alive"), (3.0, "unreadable"), (4.0, "grant"),
    ]  # fmt: skip
    with pytest.raises(InputError, match=r"none\.jsonl: the messages of a feed cannot be read"):
        read_feed("f", tmp_path / "none.jsonl")


def test_what_a_recording_has_kept_counts_in_place_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "f.jsonl").write_text('{"t_s": 3}\n', encoding="utf-8")
    feeds = {"f": FeedTable(file=tmp_path / "f.jsonl")}
    folder = tmp_path / "recording"
    folder.mkdir()
    assert [one.t_s for one in signals_of(feeds, folder)] == [3.0]
    for hour in (2, 1):
        kept = Signal("f", 3600.0 * hour, "grant", "a", taken_s=3600.0 * hour + 0.1)
        (folder / f"signals-{hour:010d}.jsonl").write_text(line_of(kept) + "\n", encoding="utf-8")
    assert [one.taken_s for one in kept_signals(folder)] == [3600.1, 7200.1]
    (folder / "signals-0000000009.jsonl").write_text("damaged, but of another hour\n")
    for span, found in (
        ((3600.1, 7200.1), [3600.1, 7200.1]), ((3601.0, 9000.0), [7200.1]), ((0.0, 3599.0), []),
    ):  # fmt: skip
        assert [one.taken_s for one in kept_between(folder, *span)] == found
    (folder / "signals-0000000009.jsonl").unlink()
    assert signals_of(feeds, folder) == signals_of(feeds, folder / "tracks.parquet")
    assert [one.t_s for one in signals_of(feeds, folder)] == [3600.0, 7200.0]
    (folder / "signals-0000000003.jsonl").write_text("{}\n", encoding="utf-8")
    with pytest.raises(
        InputError, match=r"signals-0000000003\.jsonl: message 1, .* is damaged: .*; restore"
    ):
        kept_signals(folder)


def test_a_recording_that_has_kept_no_message_takes_none_of_the_file(tmp_path: Path) -> None:
    """The file is of another day; the rules of the live site never got what it says."""
    (tmp_path / "f.jsonl").write_text('{"t_s": 3}\n', encoding="utf-8")
    feeds = {"f": FeedTable(file=tmp_path / "f.jsonl")}
    assert len(signals_of(feeds, tmp_path)) == 1
    (tmp_path / "signals-0000000001.jsonl").touch()
    assert signals_of(feeds, tmp_path) == signals_of(feeds, tmp_path / "tracks.parquet") == []


def test_a_heading_is_kept_to_the_last_bit() -> None:
    """Else the rules on a recording would judge another vehicle than the live ones did."""
    for tenth in range(-3600, 3601):
        moved = '"volume": "cart", "xy_m": [1, 2], "heading_deg"'
        message = signal_of("f", f'{{"t_s": 1, {moved}: {tenth / 10}}}')
        assert message.what == "volume"
        taken = replace(message, taken_s=8.0)
        assert recorded_signal(line_of(taken).encode()) == taken


def test_a_line_without_end_is_one_wrong_message_and_the_next_ones_are_read(tmp_path: Path) -> None:
    path = tmp_path / "f.jsonl"
    path.write_bytes(b'{"t_s": 3}\n' + b"x" * 100_000 + b'\n{"t_s": 4, "grant": "a"}\n')
    found = read_feed("f", path)
    assert [(one.t_s, one.what) for one in found] == [
        (3.0, "alive"), (3.0, "unreadable"), (4.0, "grant"),
    ]  # fmt: skip
    with path.open("rb") as file:
        assert max(map(len, _bounded(file))) <= LONGEST_LINE + 2


def test_a_kept_message_that_is_still_being_written_is_left_out(tmp_path: Path) -> None:
    line = line_of(Signal("f", 1.0, "grant", "a", taken_s=1.0))
    (tmp_path / "signals-0000000000.jsonl").write_text(f"{line}\n{line[:20]}", encoding="utf-8")
    assert len(kept_signals(tmp_path)) == 1


def test_places_in_messages_that_the_site_file_lacks_are_remarked() -> None:
    told = [
        Signal("f", 1.0), Signal("f", 1.0, "grant", "lfet"), Signal("f", 2.0, "closed", "lfet"),
        Signal("f", 1.0, "grant", "left"), Signal("f", 1.0, "gone", "cart"),
    ]  # fmt: skip
    assert list(name_remarks(told, ["left"], [])) == [
        "feed f tells of line 'lfet', which the site file does not have, and no rule heeds these "
        "messages; did you mean 'left'?",
        "feed f tells of volume 'cart', which the site file does not have, and no rule heeds these "
        "messages; it has no [volumes.NAME]",
    ]
    many = [Signal("f", 1.0, "grant", str(n)) for n in range(99)]
    assert len(list(name_remarks(many, ["left"], []))) == 11
