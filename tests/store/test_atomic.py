"""Files appear whole or not at all."""

import errno
import os
from pathlib import Path

import pytest

from trecsim.errors import InputError, SetupError
from trecsim.store.atomic import atomic_write


def names(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir())


def test_the_name_appears_when_the_block_ends(tmp_path: Path) -> None:
    with atomic_write(tmp_path / "a.txt") as file:
        file.write("whole")
        assert "a.txt" not in names(tmp_path)
    assert (tmp_path / "a.txt").read_text() == "whole"
    assert names(tmp_path) == ["a.txt"]


@pytest.mark.parametrize("fault", [ValueError, KeyboardInterrupt, SystemExit])
def test_an_error_in_the_block_keeps_the_old_file(
    tmp_path: Path, fault: type[BaseException]
) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(b"old")
    with pytest.raises(fault):
        _write_half(path, fault)
    assert path.read_bytes() == b"old"
    assert names(tmp_path) == ["a.bin"]


def _write_half(path: Path, fault: type[BaseException]) -> None:
    with atomic_write(path, "wb") as file:
        file.write(b"half")
        raise fault


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO])
def test_a_full_disk_is_told_and_leaves_nothing(tmp_path: Path, code: int) -> None:
    with (
        pytest.raises(SetupError, match=r"cannot write .*a\.txt: the disk"),
        atomic_write(tmp_path / "a.txt"),
    ):
        raise OSError(code, os.strerror(code))
    assert names(tmp_path) == []


def test_a_full_disk_found_only_when_the_file_is_closed_is_told() -> None:
    with pytest.raises(SetupError, match="disk is full"), atomic_write(Path("/dev/full")) as file:
        file.write("x")


def test_a_missing_directory_is_named(tmp_path: Path) -> None:
    with (
        pytest.raises(InputError, match="nowhere does not exist"),
        atomic_write(tmp_path / "nowhere" / "a.txt"),
    ):
        pass


def test_a_directory_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="it is a directory"), atomic_write(tmp_path):
        pass


def test_other_errors_pass_unchanged(tmp_path: Path) -> None:
    with pytest.raises(ConnectionResetError), atomic_write(tmp_path / "a.txt"):
        raise ConnectionResetError(errno.ECONNRESET, "peer")


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "target.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to(tmp_path / "target.txt")
    with atomic_write(tmp_path / "link.txt") as file:
        file.write("new")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "target.txt").read_text() == "new"


def test_a_device_is_written_to_and_not_replaced() -> None:
    with atomic_write(Path("/dev/null")) as file:
        file.write("gone")
    assert not Path("/dev/null").is_file()


def test_text_is_utf8_with_plain_line_ends(tmp_path: Path) -> None:
    with atomic_write(tmp_path / "a.txt") as file:
        file.write("Türe\n")
    assert (tmp_path / "a.txt").read_bytes() == b"T\xc3\xbcre\n"


def test_a_file_with_personal_data_is_for_its_owner_alone(tmp_path: Path) -> None:
    with atomic_write(tmp_path / "people.txt", private=True):
        pass
    with atomic_write(tmp_path / "rig.txt"):
        pass
    assert (tmp_path / "people.txt").stat().st_mode & 0o777 == 0o600
    assert (tmp_path / "rig.txt").stat().st_mode & 0o777 == 0o666 & ~umask()


def umask() -> int:
    before = os.umask(0)
    os.umask(before)
    return before
