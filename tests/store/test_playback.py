"""Recordings are listed and played back as they were stored."""

from pathlib import Path

import pytest

from made_live import assert_same_bits, live_moments
from made_tracks import walk
from trecsim.store import parquet_reading
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.playback import recordings, snapshots
from trecsim.store.recorder import Recorder
from trecsim.store.tracks import tracks_writer
from trecsim.values import Snapshot


def record(folder: Path, moments: list[Snapshot], *, end: bool = True) -> None:
    folder.mkdir(exist_ok=True)
    writer = Recorder(folder / "tracks.parquet", TracksInfo(), segment_s=2.0)
    for moment in moments:
        writer.write(moment)
    if end:
        writer.close()
    else:
        writer.abandon()


def seen(moments: list[Snapshot]) -> set[int]:
    """Return who was not only provisional."""
    return {
        person
        for one in moments
        for person, state in zip(one.id.tolist(), one.state.tolist(), strict=True)
        if state != "provisional"
    }


def test_recordings_are_listed_in_order_of_time(tmp_path: Path) -> None:
    made = {"late": list(live_moments(200, first=400)), "early": list(live_moments(200))}
    record(tmp_path / "late", made["late"], end=False)
    record(tmp_path / "early", made["early"])
    (tmp_path / "notes").mkdir()

    found = recordings(tmp_path)
    assert [one.id for one in found] == ["early", "late"]
    for one in found:
        assert (one.from_s, one.to_s) == (made[one.id][0].t_s, made[one.id][-1].t_s)
        assert one.people == len(seen(made[one.id]))
        assert one.size_bytes > 0


def test_a_folder_that_is_a_recording_is_listed_itself(tmp_path: Path) -> None:
    record(tmp_path / "run", list(live_moments(20)))

    assert [one.id for one in recordings(tmp_path / "run")] == ["run"]


def test_recordings_of_full_precision_are_listed_too(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    with tracks_writer(tmp_path / "run" / "tracks.parquet") as writer:
        for moment in walk(5, people=3):
            writer.write(moment)

    (one,) = recordings(tmp_path)
    assert (one.from_s, one.to_s, one.people) == (0.0, 0.16, 3)


def test_a_damaged_recording_is_left_out_and_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    record(tmp_path / "good", list(live_moments(20)))
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "tracks.parquet").write_bytes(b"PAR1 and then nothing")

    assert [one.id for one in recordings(tmp_path)] == ["good"]
    assert "bad" in caplog.text


def test_a_part_is_played_back_without_opening_other_hours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = list(live_moments(400))
    record(tmp_path / "run", moments)
    opened: list[str] = []
    read = parquet_reading.compact_moments

    def compact_moments(path: Path, *rest: object) -> object:
        opened.append(path.name)
        return read(path, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(parquet_reading, "compact_moments", compact_moments)
    found = list(snapshots(tmp_path / "run", moments[120].t_s, moments[130].t_s))
    assert_same_bits(found, moments[120:131])
    assert opened == ["00000003.parquet"]


def test_what_is_played_back_holds_provisional_people_and_empty_moments(tmp_path: Path) -> None:
    moments = list(live_moments(60))
    record(tmp_path / "run", moments, end=False)

    assert_same_bits(list(snapshots(tmp_path / "run")), moments)
