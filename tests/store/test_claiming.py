"""A folder belongs to one program at a time."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from trecsim.errors import InputError
from trecsim.store.claiming import LOCK, FolderClaim

# Claims a folder, says so, and waits to be killed.
HOLDER = """
import sys, time
from pathlib import Path
from trecsim.store.claiming import FolderClaim

claim = FolderClaim(Path(sys.argv[1]))
print("claimed", flush=True)
time.sleep(600)
"""


def holder(folder: Path) -> subprocess.Popen[str]:
    program = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(folder)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert program.stdout is not None
    assert program.stdout.readline() == "claimed\n"
    return program


def test_a_folder_that_another_program_holds_is_refused_and_its_process_named(
    tmp_path: Path,
) -> None:
    program = holder(tmp_path / "run")
    try:
        with pytest.raises(InputError, match=rf"run is in use: .* process number {program.pid} "):
            FolderClaim(tmp_path / "run")
    finally:
        program.kill()
        program.communicate()


def test_the_lock_of_a_killed_program_is_stale(tmp_path: Path) -> None:
    program = holder(tmp_path / "run")
    program.kill()
    program.communicate()
    assert (tmp_path / "run" / LOCK).exists()
    with FolderClaim(tmp_path / "run"):
        assert (tmp_path / "run" / LOCK).read_text() == f"{os.getpid()}\n"
    assert not (tmp_path / "run").exists()


def test_of_many_at_the_same_moment_one_gets_the_folder(tmp_path: Path) -> None:
    claims: list[FolderClaim] = []
    refused: list[InputError] = []
    begin = threading.Barrier(8)

    def claim() -> None:
        begin.wait()
        try:
            claims.append(FolderClaim(tmp_path / "run"))
        except InputError as error:
            refused.append(error)

    threads = [threading.Thread(target=claim) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (len(claims), len(refused)) == (1, 7)
    claims[0].release()


def test_what_is_in_the_folder_stays_and_the_lock_goes(tmp_path: Path) -> None:
    with FolderClaim(tmp_path / "run") as claim:
        assert claim.content == []
        (tmp_path / "run" / "kept.txt").touch()
        assert [path.name for path in claim.content] == ["kept.txt"]
    assert [path.name for path in (tmp_path / "run").iterdir()] == ["kept.txt"]


def test_a_new_folder_is_for_its_owner_alone_and_an_old_one_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "old").mkdir(mode=0o755)
    with FolderClaim(tmp_path / "new"), FolderClaim(tmp_path / "old"):
        assert (tmp_path / "new").stat().st_mode & 0o777 == 0o700
        assert (tmp_path / "old").stat().st_mode & 0o777 == 0o755


def test_a_place_that_is_a_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="expected a folder, found a file"):
        FolderClaim(tmp_path / "file")
