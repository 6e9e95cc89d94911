"""What is erased is gone from every file, and the audit log says so."""

import errno
import json
import os
from contextlib import AbstractContextManager
from pathlib import Path
from typing import IO

import numpy as np
import pytest

from made_events import made_event
from made_live import assert_same_bits, live_moments
from made_tracks import assert_same, walk
from trecsim.cli import main
from trecsim.errors import InputError, SetupError
from trecsim.store import atomic
from trecsim.store.compaction import CHANGING, changing
from trecsim.store.erasing import erase
from trecsim.store.growing import lock
from trecsim.store.in_place import overwrite
from trecsim.store.ledger import Ledger
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.playback import snapshots
from trecsim.store.recorder import Recorder
from trecsim.store.recordings import stored_in
from trecsim.store.tracks import read_tracks, tracks_writer
from trecsim.values import Snapshot

INFO = TracksInfo()


def record(folder: Path, moments: list[Snapshot], *, end: bool = True) -> Path:
    folder.mkdir(exist_ok=True, parents=True)
    writer = Recorder(folder / "tracks.parquet", INFO, segment_s=2.0)
    for moment in moments:
        writer.write(moment)
    if end:
        writer.close()
    else:
        writer.abandon()
    return folder


@pytest.mark.parametrize("end", [True, False])
def test_the_time_of_everybody_is_gone_and_all_else_is_as_before(tmp_path: Path, end: bool) -> None:
    moments = list(live_moments(200))
    run = record(tmp_path / "site" / "run", moments, end=end)

    done = erase(tmp_path / "site", moments[30].t_s, moments[120].t_s)
    assert_same_bits(list(snapshots(run)), moments[:30] + moments[121:])
    assert done.recordings == ("run",)
    assert done.rows == sum(max(one.support.size, 1) for one in moments[30:121])


def test_one_person_is_gone_and_all_others_are_as_before(tmp_path: Path) -> None:
    moments = list(live_moments(100))
    run = record(tmp_path / "run", moments)

    erase(run, -np.inf, np.inf, person=1)
    found = list(snapshots(run))
    expected = [one.of(one.id != 1) for one in moments if not np.array_equal(one.id, [1])]
    assert_same_bits(found, expected)
    assert not any(1 in one.id for one in found)


def test_what_is_left_of_whole_hours_is_nothing_and_identities_are_not_used_again(
    tmp_path: Path,
) -> None:
    moments = list(live_moments(200))
    run = record(tmp_path / "run", moments)
    before = stored_in(run).next_person

    erase(run, moments[100].t_s, np.inf)
    assert_same_bits(list(snapshots(run)), moments[:100])
    assert stored_in(run).next_person == before


def test_a_recording_that_was_tracked_from_files_is_erased_too(tmp_path: Path) -> None:
    with tracks_writer(tmp_path / "tracks.parquet") as writer:
        for one in walk(20):
            writer.write(one)

    erase(tmp_path, 0.2, 0.4)
    kept = [one for one in walk(20) if not 0.2 <= one.t_s <= 0.4]
    assert_same(list(read_tracks(tmp_path)), kept)


def test_2d_poses_are_erased_with_everybody_and_told_of_with_one_person(tmp_path: Path) -> None:
    run = record(tmp_path / "run", list(live_moments(10)))
    lines = ['{"format": "trecsim.poses2d/1", "skeleton": "coco17"}']
    lines += [json.dumps({"camera": "a", "t_s": 1.7e9 + n, "people": []}) for n in range(5)]
    (run / "poses.jsonl").write_text("\n".join(lines) + "\n")

    assert "poses.jsonl" in erase(run, 1.7e9, 1.7e9 + 2, person=0).remarks[0]
    assert erase(run, 1.7e9 + 1, 1.7e9 + 2).remarks == ()
    assert (run / "poses.jsonl").read_text().splitlines() == [lines[0], *lines[1:2], *lines[4:]]


def no_room(path: Path, mode: str, private: bool = False) -> IO[bytes]:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_on_a_full_disk_files_are_changed_where_they_lie(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = list(live_moments(60))
    run = record(tmp_path / "run", moments)
    lines = [json.dumps({"camera": "a", "t_s": one.t_s, "people": []}) for one in moments]
    (run / "poses.jsonl").write_text("\n".join(lines) + "\n")
    (first, *_) = sorted((run / "tracks.parquet").glob("0*.parquet"))
    size = first.stat().st_size
    monkeypatch.setattr(atomic, "_open", no_room)

    assert erase(run, moments[10].t_s, moments[49].t_s).files == 1
    assert_same_bits(list(snapshots(run)), moments[:10] + moments[50:])
    assert (run / "poses.jsonl").read_text().splitlines() == lines[:10] + lines[50:]
    assert first.stat().st_size < size


def test_a_file_that_would_grow_in_its_place_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"old")
    with pytest.raises(SetupError):
        overwrite(tmp_path / "file", b"longer")
    assert (tmp_path / "file").read_bytes() == b"old"


def test_the_act_is_in_the_audit_log_of_the_site(tmp_path: Path) -> None:
    moments = list(live_moments(20))
    run = record(tmp_path / "run", moments)
    Ledger(tmp_path).close()

    erase(run, moments[3].t_s, np.inf, person=0, who="kim")
    with Ledger(tmp_path) as ledger:
        (entry,) = ledger.audit()
        assert (entry.who, entry.act) == ("kim", "erase")
        assert entry.details["person"] == 0
        assert entry.details["from_s"] == moments[3].t_s
        assert entry.details["to_s"] is None
        assert entry.details["rows"] > 0
        assert ledger.verify_audit().is_whole
    assert not (run / "ledger.sqlite").exists()


def test_a_site_goes_on_recording_while_something_is_erased(tmp_path: Path) -> None:
    moments = list(live_moments(120))
    (tmp_path / "run").mkdir()
    path = tmp_path / "run" / "tracks.parquet"
    with Recorder(path, INFO, part_s=0.001, segment_s=2.0, parts_of_a_minute=3) as writer:
        for number, moment in enumerate(moments):
            writer.write(moment)
            if number % 20 == 19:
                erase(tmp_path, moments[number - 12].t_s, moments[number - 10].t_s)
    gone = {n + offset for n in range(19, 120, 20) for offset in (-12, -11, -10)}
    left = {one.t_s for one in snapshots(tmp_path / "run")}

    never = {moment.t_s for n, moment in enumerate(moments) if n not in gone}
    assert never <= left  # what had not been stored yet may have come later


def test_a_recording_that_ends_just_before_it_is_changed_is_erased_under_its_final_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = list(live_moments(50))
    (tmp_path / "run").mkdir()
    writer = Recorder(tmp_path / "run" / "tracks.parquet", INFO)
    for moment in moments:
        writer.write(moment)

    def changing_after_the_end(folder: Path) -> AbstractContextManager[bool]:
        writer.close()
        return changing(folder)

    monkeypatch.setattr("trecsim.store.erasing.changing", changing_after_the_end)
    erase(tmp_path, moments[10].t_s, moments[20].t_s)

    left = [one.t_s for one in snapshots(tmp_path / "run")]
    assert left == [one.t_s for one in (*moments[:10], *moments[21:])]


@pytest.mark.parametrize("segment_s", [2.0, 3600.0])
def test_a_recording_takes_its_final_name_while_nobody_else_can_change_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, segment_s: float
) -> None:
    writer = Recorder(tmp_path / "tracks.parquet", INFO, segment_s=segment_s)
    for moment in live_moments(120):
        writer.write(moment)
    take_name, could_be_locked = writer._take_name, []

    def look_and_take_name() -> None:
        with (tmp_path / "tracks.parquet.parts" / CHANGING).open() as other:
            could_be_locked.append(lock(other.fileno()))
        take_name()

    monkeypatch.setattr(writer, "_take_name", look_and_take_name)
    writer.close()

    assert could_be_locked == [False]
    assert not (tmp_path / "tracks.parquet.parts").exists()


def test_a_recording_that_is_not_there_and_a_time_that_is_none_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no recording"):
        erase(tmp_path, 0.0, 1.0)
    record(tmp_path / "run", list(live_moments(5)))
    with pytest.raises(InputError, match="earlier to a later"):
        erase(tmp_path, 2.0, 1.0)


def test_the_command_takes_dates_and_tells_what_it_did(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    moments = list(live_moments(50))
    run = record(tmp_path / "run", moments)
    arguments = [
        "erase",
        os.fspath(run),
        "--from",
        "2023-11-14T22:13:21",
        "--to",
        "1.8e9",
        "--json",
    ]

    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 0
    assert json.loads(capsys.readouterr().out)["recordings"] == ["run"]
    assert_same_bits(list(snapshots(run)), [one for one in moments if one.t_s < 1.7e9 + 1])

    with pytest.raises(SystemExit) as ended:
        main(["erase", os.fspath(run), "--from", "yesterday", "--to", "1"])
    assert ended.value.code == 2
    assert "yesterday" in capsys.readouterr().err


def test_a_damaged_recording_is_told_and_the_period_is_gone_from_all_others(
    tmp_path: Path,
) -> None:
    moments = list(live_moments(100))
    site = tmp_path / "site"
    record(site / "a", moments)
    whole = record(site / "b", moments)
    next((site / "a" / "tracks.parquet").glob("0*")).write_bytes(b"PAR1 cut off")

    with pytest.raises(InputError, match="1 of 2 recordings still hold this period"):
        erase(site, moments[30].t_s, moments[60].t_s)
    assert_same_bits(list(snapshots(whole)), moments[:30] + moments[61:])
    with Ledger(site) as ledger:
        assert [one.details["recordings"] for one in ledger.audit()] == [["b"]]


def test_where_the_ledger_is_damaged_nothing_is_deleted_and_it_stays(tmp_path: Path) -> None:
    moments = list(live_moments(50))
    run = record(tmp_path / "site" / "run", moments)
    ledger = tmp_path / "site" / "ledger.sqlite"
    ledger.write_bytes(b"no database, but perhaps people" * 100)
    with pytest.raises(InputError, match=r"ledger\.sqlite is damaged.* nothing was deleted"):
        erase(tmp_path / "site", moments[0].t_s, moments[-1].t_s)
    assert_same_bits(list(snapshots(run)), moments)
    assert [one.name for one in ledger.parent.glob("ledger*")] == ["ledger.sqlite"]


def test_events_of_the_time_do_not_list_whom_was_erased_and_others_stay(tmp_path: Path) -> None:
    run = record(tmp_path / "run", list(walk(100, people=2)))
    here = [{"person": 0, "floor_m": [41.5, 2.0]}, {"person": 1, "floor_m": [3.0, 2.0]}]
    with Ledger(run) as ledger:
        for name, t_s in (("in", 1.0), ("after", 3.0)):
            times = {"t_start_s": t_s, "t_detect_s": t_s, "people": here}
            ledger.append_event(made_event(name, **times))
        until = {"t_start_s": 0.1, "t_detect_s": 2.5, "t_end_s": 2.5, "people": here}
        ledger.append_event(made_event("from before to after", "end", **until))
    done = erase(run, 0.5, 2.0, person=0)
    assert done.events == 2
    with Ledger(run) as ledger:
        listed = [[one["person"] for one in e.event["data"]["people"]] for e in ledger.events()]
        ids = [one.event["id"] for one in ledger.events()]
        assert ledger.audit()[-1].details["events"] == 2
    assert listed == [[1], [0, 1], [1]]
    assert ids[0] == made_event("in")["id"]
    assert erase(run, 0.5, 2.0, person=0).events == 0
    erase(run, -np.inf, np.inf)
    with Ledger(run) as ledger:
        assert all(not one.event["data"]["people"] for one in ledger.events())
    for file in run.glob("ledger.sqlite*"):
        assert b"41.5" not in file.read_bytes(), file
