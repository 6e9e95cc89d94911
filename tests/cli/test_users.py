"""The commands for users and the audit log."""

import io
import json
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import pytest

from trecsim.page import passwords
from trecsim.page.users_file import read_users
from trecsim.store.ledger import Ledger

Command = Callable[..., tuple[int, str, str]]
PASSWORD = "a long password"


@pytest.fixture
def users(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a file for users that is not there yet; hashes are quick."""
    quick = passwords.PasswordHasher(time_cost=1, memory_cost=8, parallelism=1)
    monkeypatch.setattr(passwords, "_HASHER", quick)
    return tmp_path / "users.toml"


@pytest.fixture
def add(trecsim: Command, users: Path, monkeypatch: pytest.MonkeyPatch) -> Command:
    def run(*arguments: str, password: str = PASSWORD) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.stdin", io.StringIO(password + "\n"))
        return trecsim("users", "add", *arguments, "--file", users)

    return run


def test_a_user_is_added_listed_changed_and_removed(
    trecsim: Command, add: Command, users: Path
) -> None:
    assert add("anna", "--role", "admin") == (0, f"{users}: anna (admin) may sign in\n", "")
    assert add("ben@site.example", "--role", "viewer")[0] == 0
    assert trecsim("users", "role", "ben@site.example", "operator", "--file", users)[0] == 0
    assert trecsim("users", "list", "--file", users)[1] == (
        "admin     anna\noperator  ben@site.example\n"
    )
    assert trecsim("users", "remove", "anna", "--file", users)[0] == 0
    code, out, _ = trecsim("users", "list", "--file", users, "--json")
    assert code == 0
    assert json.loads(out)["users"] == {"ben@site.example": "operator"}


def test_the_password_is_kept_as_a_hash_that_it_fits(add: Command, users: Path) -> None:
    add("anna", "--role", "admin")
    assert PASSWORD not in users.read_text()
    assert users.stat().st_mode & 0o777 == 0o600
    first = read_users(users)["anna"].password
    assert passwords.fits(PASSWORD, first)
    code, out, _ = add("anna", password="another password")
    assert (code, out) == (0, f"{users}: anna (admin) has a new password\n")
    second = read_users(users)["anna"]
    assert second.role == "admin"
    assert passwords.fits("another password", second.password)


@pytest.mark.parametrize(
    ("arguments", "password", "said"),
    [
        (("anna",), PASSWORD, "anna is new: expected --role"),
        (("a b", "--role", "admin"), PASSWORD, "user names have up to 64 letters"),
        (("token", "--role", "admin"), PASSWORD, "is reserved"),
        (("anna", "--role", "admin"), "short", "10 to 1000 characters, found 5"),
        (("anna", "--role", "admin"), "", "10 to 1000 characters, found 0"),
        (("anna", "--role", "boss"), PASSWORD, "boss"),
    ],
)
def test_what_cannot_be_a_user_is_told_and_changes_nothing(
    add: Command, users: Path, arguments: tuple[str, ...], password: str, said: str
) -> None:
    code, out, err = add(*arguments, password=password)
    assert (code, out) == (2, "")
    assert said in err
    assert not users.exists()


def test_a_user_who_is_not_there_is_told_with_those_who_are(
    trecsim: Command, add: Command, users: Path
) -> None:
    add("anna", "--role", "admin")
    for arguments in (("remove", "ben"), ("role", "ben", "viewer")):
        code, _, err = trecsim("users", *arguments, "--file", users)
        assert code == 2
        assert "has no user 'ben'; it has: anna" in err


@pytest.mark.parametrize(
    "arguments", [("list",), ("remove", "ben"), ("role", "ben", "viewer")], ids=lambda one: one[0]
)
def test_who_has_no_file_of_users_yet_is_told_how_to_make_one(
    trecsim: Command, users: Path, arguments: tuple[str, ...]
) -> None:
    code, _, err = trecsim("users", *arguments, "--file", users)
    assert code == 2
    assert f"there is no {users}: expected a file of users; trecsim users add NAME" in err


def test_the_package_is_run_as_the_command_is() -> None:
    said = subprocess.run(
        [sys.executable, "-m", "trecsim", "--version"], capture_output=True, text=True, check=True
    )
    assert said.stdout.strip() == f"trecsim {version('mc3d-trecsim')}"


def test_passwords_typed_twice_must_agree(
    trecsim: Command, users: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    typed = iter([PASSWORD, PASSWORD + "x"])
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("trecsim.cli.users_command.getpass", lambda _: next(typed))
    code, _, err = trecsim("users", "add", "anna", "--role", "admin", "--file", users)
    assert code == 2
    assert "the two passwords differ" in err


def test_an_audit_log_is_whole_until_somebody_changes_it(trecsim: Command, tmp_path: Path) -> None:
    with Ledger(tmp_path / "site") as ledger:
        for number in range(3):
            ledger.append_audit("anna", "login", {"number": number})
        last = ledger.audit()[-1].hash
    code, out, _ = trecsim("audit", "verify", tmp_path)
    assert (code, out) == (0, f"{tmp_path}: unchanged, 3 entries, last hash {last}\n")
    file = sqlite3.connect(tmp_path / "site" / "ledger.sqlite")
    file.execute("UPDATE audit SET who = 'ben' WHERE number = 2")
    file.commit()
    file.close()
    code, out, err = trecsim("audit", "verify", tmp_path, "--json")
    assert (code, out) == (1, "")
    assert "was changed: entry 2 of 3 does not fit" in err


def test_a_folder_without_a_ledger_is_told(trecsim: Command, tmp_path: Path) -> None:
    code, _, err = trecsim("audit", "verify", tmp_path)
    assert code == 2
    assert "expected a folder with one ledger (ledger.sqlite), found none" in err
    assert list(tmp_path.iterdir()) == []
