"""Exports that cannot be: one line that says why, and nothing left behind."""

import os
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from made_motion import exported, recorded, two_walkers, walking_m
from trecsim import cli, extras
from trecsim.errors import Error, InputError, SetupError
from trecsim.export.formats import FORMATS
from trecsim.export.placing import placed

ENDINGS = [
    one.ending for one in FORMATS if one.ending not in (".nc", ".rrd", ".usdc", ".csv", ".parquet")
]


@pytest.fixture
def trecsim(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    def run(*arguments: object) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as ended:
            cli.main([str(argument) for argument in arguments])
        told = capsys.readouterr()
        return int(str(ended.value.code)), told.out, told.err

    return run


def test_an_unknown_ending_is_told_what_there_is(tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    with pytest.raises(InputError) as refused:
        exported(tracks, tmp_path / "o.fbx")
    for one in FORMATS:
        assert one.ending in str(refused.value)


@pytest.mark.parametrize("ending", ENDINGS)
def test_tracks_without_anybody_are_refused(ending: str, tmp_path: Path) -> None:
    tracks = recorded(tmp_path / "t.csv", {}, np.empty(0))
    with pytest.raises(InputError, match="nobody"):
        exported(tracks, tmp_path / f"o{ending}")
    assert sorted(tmp_path.iterdir()) == [tracks]


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("frames", [1, 2, 3])
def test_a_person_of_few_frames_is_exported(ending: str, frames: int, tmp_path: Path) -> None:
    t_s = np.arange(40) / 25.0
    short = walking_m(t_s, 1)
    short[frames:] = np.nan
    tracks = recorded(tmp_path / "t.csv", {0: walking_m(t_s), 1: short}, t_s)
    done = exported(tracks, tmp_path / f"o{ending}")
    assert done.people == 2
    assert all(file.stat().st_size for file in done.files)


@pytest.mark.parametrize("ending", [".trc", ".bvh", ".c3d", ".pedpy.txt"])
def test_a_single_time_has_no_rate(ending: str, tmp_path: Path) -> None:
    t_s = np.zeros(1)
    tracks = recorded(tmp_path / "t.csv", {0: walking_m(t_s)}, t_s)
    with pytest.raises(InputError, match="--rate-hz"):
        exported(tracks, tmp_path / f"o{ending}")
    assert exported(tracks, tmp_path / f"o{ending}", rate_hz=25.0).moments == 1


def test_a_person_who_is_not_there_is_told_who_is(tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    with pytest.raises(InputError, match="no person 5; there are 3, 7"):
        exported(tracks, tmp_path / "o.trc", person=5)


@pytest.mark.parametrize("settings", [{"rate_hz": 0.0}, {"rate_hz": np.nan}, {"fill_s": -1.0}])
def test_numbers_that_cannot_be_are_refused(settings: dict[str, float], tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    with pytest.raises(InputError, match="expected"):
        exported(tracks, tmp_path / "o.trc", **settings)


def test_a_missing_package_is_named_with_the_command_that_installs_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(extras, "import_module", missing)
    tracks, _, _ = two_walkers(tmp_path)
    for ending, package in (
        (".c3d", "ezc3d"),
        (".rrd", "rerun"),
        (".nc", "movement"),
        (".usdc", "usd-core"),
    ):
        with pytest.raises(SetupError, match=rf"needs {package}: .*install"):
            exported(tracks, tmp_path / f"o{ending}")
    assert sorted(tmp_path.iterdir()) == [tracks]


def test_files_appear_all_together_or_not_at_all(tmp_path: Path) -> None:
    old = tmp_path / "a_0.trc"
    old.write_text("old")

    def interrupted() -> None:
        with placed([old, tmp_path / "a_1.trc"]) as places:
            places[0].write_text("new")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("a_0.trc", "old")]
    with placed([old, tmp_path / "a_1.trc"]) as places:
        for place in places:
            place.write_text("new")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a_0.trc", "a_1.trc"]
    assert old.read_text() == "new"


@pytest.mark.parametrize("ending", [".json", ".glb", ".trc", ".usda", ".bvh"])
def test_a_full_disk_is_told_and_nothing_is_left(
    ending: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tracks, _, _ = two_walkers(tmp_path)

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(SetupError, match="the disk is full"):
        exported(tracks, tmp_path / f"o{ending}")
    assert sorted(tmp_path.iterdir()) == [tracks]


@pytest.mark.parametrize("kept", [100, 600, 5_000])
def test_a_c3d_file_that_ends_too_early_is_a_full_disk(
    kept: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ezc3d = pytest.importorskip("ezc3d")
    tracks, _, _ = two_walkers(tmp_path)
    whole = ezc3d.c3d.write

    def cut(file: object, path: str) -> None:
        whole(file, path)
        os.truncate(path, kept)

    monkeypatch.setattr(ezc3d.c3d, "write", cut)
    with pytest.raises(SetupError, match="the disk is full"):
        exported(tracks, tmp_path / "o.c3d")
    assert sorted(tmp_path.iterdir()) == [tracks]


@pytest.mark.parametrize("ending", [".usdc", ".rrd"])
def test_a_full_disk_is_told_where_other_packages_write(ending: str, tmp_path: Path) -> None:
    for name in ("pxr.Sdf", "rerun"):
        pytest.importorskip(name, reason="optional packages are not installed")
    resource = pytest.importorskip("resource")
    tracks, _, _ = two_walkers(tmp_path)
    (whole,) = exported(tracks, tmp_path / f"whole{ending}").files
    size, limits = whole.stat().st_size, resource.getrlimit(resource.RLIMIT_FSIZE)
    whole.unlink()
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size // 2, limits[1]))
    try:
        with pytest.raises(SetupError, match="the size of files is limited"):
            exported(tracks, tmp_path / f"o{ending}")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, ignored)
    assert sorted(tmp_path.iterdir()) == [tracks]


@pytest.mark.parametrize("ending", [".trc", ".c3d", ".glb"])
def test_a_folder_that_is_missing_is_told_before_anything_is_done(
    ending: str, tmp_path: Path
) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    with pytest.raises(Error, match="does not exist"):
        exported(tracks, tmp_path / "none" / f"o{ending}")


def test_the_command_tells_of_files_rate_and_what_was_missing(
    trecsim: Callable[..., tuple[int, str, str]], tmp_path: Path
) -> None:
    tracks, _, _ = two_walkers(tmp_path, "a walk.csv")
    code, out, err = trecsim("export", tracks, tmp_path / "o.trc")
    assert code == 0
    assert out.startswith(f"{tmp_path}/o_3.trc to o_7.trc (2 files): 100 frames at 25 frames")
    assert "25 frames without tracks are left empty" in err
    code, out, err = trecsim("export", tracks, tmp_path / "o.bvh", "--fill-s", "2")
    assert (code, err) == (0, "")


def test_the_command_refuses_in_one_line(
    trecsim: Callable[..., tuple[int, str, str]], tmp_path: Path
) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    for arguments in (
        (tracks, "o.fbx"),
        (tmp_path / "none.csv", "o.trc"),
        (tracks, "o.trc", "--person", 9),
    ):
        code, out, err = trecsim("export", *arguments)
        assert (code, out) == (2, "")
        assert err.strip().count("\n") == 0
