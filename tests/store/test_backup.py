"""A backup of a site that runs can be restored, and other archives are refused."""

import io
import json
import stat
import tarfile
import time
from pathlib import Path

import pytest

from made_live import assert_same_bits, live_moments
from trecsim.cli import main
from trecsim.errors import InputError
from trecsim.page.site_history import SiteHistory
from trecsim.store.backup import backup, restore
from trecsim.store.ledger import Ledger
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.playback import snapshots
from trecsim.store.site_store import SiteStore

INFO = TracksInfo()


def test_a_site_that_runs_is_backed_up_and_restored(tmp_path: Path) -> None:
    moments = list(live_moments(200))
    site, archive = tmp_path / "site", tmp_path / "site.tar"
    (site / "run").mkdir(parents=True)
    with SiteStore(site) as store:
        store.ledger.append_event({"id": "a", "data": {"event": "e"}})
        store.ledger.append_audit("kim", "login")
        with store.recorder(site / "run", INFO) as writer:
            for moment in moments[:100]:
                writer.write(moment)
            (site / "run" / "timing.csv.partial").write_text("t_s\n")
            while writer.stored_s < moments[99].t_s:
                time.sleep(0.01)
            done = backup(site, archive)
            for moment in moments[100:]:
                writer.write(moment)
            store.ledger.append_event({"id": "b", "data": {"event": "e"}})

    assert (done.recordings, done.events) == (1, 1)
    found = restore(archive, tmp_path / "again")
    assert (found.recordings, found.events, found.files) == (1, 1, done.files - 1)
    assert_same_bits(list(snapshots(tmp_path / "again" / "run")), moments[:100])
    assert (tmp_path / "again" / "run" / "timing.csv.partial").read_text() == "t_s\n"
    with Ledger(tmp_path / "again") as ledger:
        assert [one.event["id"] for one in ledger.events()] == ["a"]
        assert ledger.verify_audit().entries == 1


@pytest.mark.parametrize("name", [".", "run"])
def test_repairs_of_the_rig_are_backed_up_but_not_the_poses_that_one_works_on(
    tmp_path: Path, name: str
) -> None:
    site = tmp_path / "site"
    (site / name).mkdir(parents=True)
    with SiteStore(site) as store, store.recorder(site / name, INFO) as writer:
        for moment in live_moments(5):
            writer.write(moment)
    (site / "repairs" / ".repair-a").mkdir(parents=True)
    (site / "repairs" / ".repair-a" / "poses.jsonl").write_text("{}")
    (site / "repairs" / "current.json").write_text("{}")
    backup(site, tmp_path / "site.tar")
    restore(tmp_path / "site.tar", tmp_path / "again")
    kept = sorted((tmp_path / "again" / "repairs").rglob("*"))
    assert [path.name for path in kept] == ["current.json"]


def test_earlier_versions_of_the_site_file_are_backed_up(tmp_path: Path) -> None:
    site = tmp_path / "site"
    history = SiteHistory(site)
    with SiteStore(site):
        history.keep("zones as they were", "0" * 64)
        backup(site, tmp_path / "site.tar")
    restore(tmp_path / "site.tar", tmp_path / "again")
    assert SiteHistory(tmp_path / "again").text("0" * 64) == "zones as they were"


def test_links_are_left_out_and_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    run = tmp_path / "site" / "run"
    run.mkdir(parents=True)
    (tmp_path / "elsewhere.parquet").write_bytes(b"tracks")
    (run / "tracks.parquet").symlink_to(tmp_path / "elsewhere.parquet")
    Ledger(tmp_path / "site").close()
    backup(tmp_path / "site", tmp_path / "site.tar")
    assert f"{run / 'tracks.parquet'} is a link and not part of the backup" in caplog.text


def test_a_backup_and_what_is_restored_are_for_their_owner_alone(tmp_path: Path) -> None:
    site = tmp_path / "site"
    (site / "run").mkdir(parents=True)
    with SiteStore(site) as store, store.recorder(site / "run", INFO) as writer:
        writer.write(next(iter(live_moments(1))))
    backup(site, tmp_path / "a.tar")
    restore(tmp_path / "a.tar", tmp_path / "again")

    assert stat.S_IMODE((tmp_path / "a.tar").stat().st_mode) == 0o600
    made = [tmp_path / "again", *(tmp_path / "again").rglob("*")]
    assert {stat.S_IMODE(one.stat().st_mode) for one in made} == {0o600, 0o700}
    assert not [one for one in made if one.name in (".lock", ".changing")]


def test_a_backup_lies_outside_and_a_folder_without_anything_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="found neither"):
        backup(tmp_path, tmp_path.parent / "x.tar")
    Ledger(tmp_path).close()
    with pytest.raises(InputError, match="lies in"):
        backup(tmp_path, tmp_path / "x.tar")


def archive(path: Path, *members: tuple[str, bytes]) -> Path:
    with tarfile.open(path, "w") as tar:
        for name, content in members:
            info = tarfile.TarInfo(name)
            info.size = len(content)
            tar.addfile(info, io.BytesIO(content))
    return path


MARK = (".trecsim-backup", b"trecsim.backup/1\n")


@pytest.mark.parametrize(
    ("members", "told"),
    [
        ((("notes.txt", b"hello"),), "no backup of trecsim"),
        (((".trecsim-backup", b"trecsim.backup/2\n"),), "newer"),
        ((MARK, ("../outside", b"x")), "cannot be part"),
        ((MARK, ("/etc/passwd", b"x")), "cannot be part"),
        ((MARK, ("a", b"x"), ("a", b"y")), "two files at the same place"),
        ((MARK, ("a", b"x"), ("a/b", b"y")), "two files at the same place"),
        ((MARK,), "holds nothing"),
        ((MARK, ("ledger.sqlite", b"no database" * 1000)), "damaged"),
    ],
)
def test_what_is_no_backup_is_refused_and_leaves_nothing(
    tmp_path: Path, members: tuple[tuple[str, bytes], ...], told: str
) -> None:
    path = archive(tmp_path / "a.tar", *members)

    with pytest.raises(InputError, match=told):
        restore(path, tmp_path / "again")
    assert [one.name for one in tmp_path.iterdir()] == ["a.tar"]


def test_a_cut_archive_is_refused_and_leaves_nothing(tmp_path: Path) -> None:
    Ledger(tmp_path / "site").close()
    backup(tmp_path / "site", tmp_path / "a.tar")
    (tmp_path / "a.tar").write_bytes((tmp_path / "a.tar").read_bytes()[:3000])

    with pytest.raises(InputError, match="damaged"):
        restore(tmp_path / "a.tar", tmp_path / "again")
    assert not (tmp_path / "again").exists()


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    Ledger(tmp_path / "site").close()
    backup(tmp_path / "site", tmp_path / "a.tar")

    with pytest.raises(InputError, match="not empty"):
        restore(tmp_path / "a.tar", tmp_path / "site")


def test_the_commands_tell_what_they_did(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Ledger(tmp_path / "site").close()
    for arguments in (["backup", "site", "a.tar"], ["restore", "a.tar", "again"]):
        command, *paths = arguments
        with pytest.raises(SystemExit) as ended:
            main([command, *(str(tmp_path / path) for path in paths), "--json"])
        assert ended.value.code == 0
        assert json.loads(capsys.readouterr().out)["recordings"] == 0
    assert (tmp_path / "again" / "ledger.sqlite").exists()
