"""What a live site keeps, and what it deletes of itself."""

from pathlib import Path
from typing import Any

import pytest

from made_live import assert_same_bits, live_moments
from trecsim.errors import InputError, SetupError
from trecsim.store import erasing
from trecsim.store.ledger import Ledger
from trecsim.store.names import LIVE
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.playback import recordings, snapshots
from trecsim.store.recorder import Recorder
from trecsim.store.retention import Retention, tidy
from trecsim.store.site_store import SiteStore
from trecsim.values import Snapshot

HOUR = 3600.0
INFO = TracksInfo()
STEP_S = 601.0  # six moments an hour


def hours(count: int, first: int = 0) -> list[Snapshot]:
    """Return snapshots of so many hours, from 1.7e9 s on."""
    return list(live_moments(6 * count, first=6 * first, step_s=STEP_S))


def record(folder: Path, moments: list[Snapshot], *, end: bool = True, live: bool = True) -> Path:
    folder.mkdir(parents=True)
    if live:
        (folder / LIVE).touch()
    writer = Recorder(folder / "tracks.parquet", INFO)
    for moment in moments:
        writer.write(moment)
    if end:
        writer.close()
    else:
        writer.abandon()
    return folder


def event(ledger: Ledger, t_s: float, reach_s: float = 5.0) -> None:
    evidence = {"t_from_s": t_s - reach_s, "t_to_s": t_s + reach_s, "cameras": []}
    data = {"event": f"at {t_s}", "phase": "new", "t_detect_s": t_s, "evidence": evidence}
    ledger.append_event({"id": f"id {t_s}", "data": data})


def test_hours_that_are_old_enough_go_and_newer_ones_stay(tmp_path: Path) -> None:
    moments = hours(10)
    run = record(tmp_path / "run", moments)
    with Ledger(tmp_path) as ledger:
        now_s = moments[35].t_s + 72 * HOUR + 1  # the sixth hour is just over its time
        assert tidy(tmp_path, ledger, Retention(), now_s) == 6
        assert tidy(tmp_path, ledger, Retention(), now_s) == 0
        entries = [(one.who, one.act) for one in ledger.audit()]

    assert_same_bits(list(snapshots(run)), moments[36:])
    assert entries == [("retention", "delete")]


def test_a_recording_of_which_nothing_is_left_goes_as_a_whole(tmp_path: Path) -> None:
    moments = hours(3)
    run = record(tmp_path / "run", moments)
    (run / "rig.toml").write_text("a rig")
    with Ledger(tmp_path) as ledger:
        tidy(tmp_path, ledger, Retention(), moments[-1].t_s + 73 * HOUR)

    assert not run.exists()


def test_what_an_event_points_to_stays_as_long_as_the_event_and_nothing_else(
    tmp_path: Path,
) -> None:
    moments = hours(5)
    run = record(tmp_path / "run", moments)
    limits = Retention(tracks_s=72 * HOUR, events_s=90 * 86400.0)
    with Ledger(tmp_path) as ledger:
        event(ledger, moments[14].t_s, reach_s=1.5 * STEP_S)
        tidy(tmp_path, ledger, limits, moments[-1].t_s + 80 * 86400.0)
        assert_same_bits(list(snapshots(run)), moments[13:16])
        assert tidy(tmp_path, ledger, limits, moments[-1].t_s + 80 * 86400.0) == 0

        tidy(tmp_path, ledger, limits, moments[-1].t_s + 91 * 86400.0)
        assert ledger.events() == []
    assert not run.exists()


def test_too_much_goes_from_the_oldest_on_but_never_what_an_event_points_to(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    old = record(tmp_path / "old", hours(4))
    new = record(tmp_path / "new", hours(4, first=10))
    size_bytes = sum(one.size_bytes for one in recordings(tmp_path))
    now_s = hours(1, first=14)[0].t_s
    with Ledger(tmp_path) as ledger:
        event(ledger, hours(4)[7].t_s)  # in the second of eight hours
        tidy(tmp_path, ledger, Retention(tracks_bytes=size_bytes * 0.68), now_s)
        assert_same_bits(list(snapshots(old)), hours(4)[6:12])
        assert_same_bits(list(snapshots(new)), hours(4, first=10))
        assert "allowed" not in caplog.text

        tidy(tmp_path, ledger, Retention(tracks_bytes=0.0), now_s)
        assert_same_bits(list(snapshots(old)), hours(4)[6:12])
        assert not new.exists()
        assert "belongs to events" in caplog.text


def test_recordings_that_were_not_made_live_are_left_alone(tmp_path: Path) -> None:
    moments = hours(2)
    run = record(tmp_path / "study", moments, live=False)
    with Ledger(tmp_path) as ledger:
        assert tidy(tmp_path, ledger, Retention(tracks_bytes=0.0), moments[-1].t_s + 1e9) == 0

    assert_same_bits(list(snapshots(run)), moments)


def test_the_hour_that_is_written_is_left_alone(tmp_path: Path) -> None:
    moments = hours(3)
    (tmp_path / "run").mkdir()
    with SiteStore(tmp_path, now=lambda: moments[-1].t_s + 100 * HOUR) as store:
        assert store.health.state == "off"
        writer = store.recorder(tmp_path / "run", INFO)
        for moment in moments:
            writer.write(moment)
        writer.abandon()
        writer = store.recorder(tmp_path / "run", INFO, resume=True)
        late = hours(1, first=3)
        for moment in late:
            writer.write(moment)
        assert store.health.state == "writing"
        store._tidy()
        writer.close()

    found = list(snapshots(tmp_path / "run"))
    assert_same_bits(found[-len(late) :], late)


def test_a_crashed_recording_is_deleted_too(tmp_path: Path) -> None:
    moments = hours(2)
    run = record(tmp_path / "run", moments, end=False)
    with Ledger(tmp_path) as ledger:
        tidy(tmp_path, ledger, Retention(), moments[-1].t_s + 80 * HOUR)

    assert not run.exists()


def test_old_hours_go_from_a_full_disk_which_has_no_room_to_note_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = hours(4)
    run = record(tmp_path / "run", moments)

    def full(*_: object, **__: object) -> int:
        raise SetupError("the disk is full")

    write = erasing.write_catalogue
    catalogues = iter([full, write])  # after the first deletion there is room

    def written(*given: Any, **more: Any) -> None:
        next(catalogues, write)(*given, **more)

    monkeypatch.setattr(erasing, "write_catalogue", written)
    with Ledger(tmp_path) as ledger:
        monkeypatch.setattr(ledger, "forget_events", full)
        with pytest.raises(SetupError, match="the disk is full"):
            tidy(tmp_path, ledger, Retention(tracks_s=1.5 * HOUR), moments[-1].t_s)
        assert [one.act for one in ledger.audit()] == ["delete"]
    left = [one.t_s for one in snapshots(run)]
    assert left == [one.t_s for one in moments][-len(left) :]
    assert len(left) < len(moments)


def test_a_damaged_recording_does_not_keep_others_beyond_their_limit(tmp_path: Path) -> None:
    moments = hours(2)
    damaged = record(tmp_path / "a", moments)
    record(tmp_path / "b", moments)
    next((damaged / "tracks.parquet").glob("0*")).write_bytes(b"PAR1 cut off")

    with Ledger(tmp_path) as ledger, pytest.raises(InputError, match=r"PAR1|[Pp]arquet"):
        tidy(tmp_path, ledger, Retention(tracks_s=HOUR), moments[-1].t_s + 5 * HOUR)
    assert damaged.exists()
    assert not (tmp_path / "b").exists()


def test_a_folder_belongs_to_one_site_at_a_time(tmp_path: Path) -> None:
    with SiteStore(tmp_path), pytest.raises(InputError, match="in use: the site with process"):
        SiteStore(tmp_path)
    with SiteStore(tmp_path) as store:
        assert store.ledger.count_events() == 0
