"""Credentials: where they are looked for, and that no message shows them."""

from pathlib import Path

import pytest

from trecsim.errors import ConfigError
from trecsim.sources.streams.camera_login import Login, find_key, find_login, read_secrets


def secrets_file(folder: Path, text: str, mode: int = 0o600) -> Path:
    path = folder / "secrets.toml"
    path.write_text(text)
    path.chmod(mode)
    return path


def test_the_environment_goes_first_then_the_file(tmp_path: Path) -> None:
    path = secrets_file(tmp_path, 'north-gate = "me:from:file"\n')
    login = find_login("north-gate", path, {"TRECSIM_CREDENTIALS_NORTH_GATE": "me:from env"})
    assert login == Login("me", "from env")
    assert find_login("north-gate", path, {}) == Login("me", "from:file")


def test_missing_credentials_are_told_with_both_places(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"TRECSIM_CREDENTIALS_NORTH to .*name a file"):
        find_login("north", None, {})
    path = secrets_file(tmp_path, 'south = "a:b"\n')
    with pytest.raises(ConfigError, match=r"add a line north = .* to .*secrets\.toml"):
        find_login("north", path, {})


def test_secrets_that_everybody_can_read_are_refused(tmp_path: Path) -> None:
    path = secrets_file(tmp_path, 'north = "a:b"\n', 0o644)
    with pytest.raises(ConfigError, match=r"every user .* can read .*chmod 600"):
        read_secrets(path)
    path.chmod(0o640)
    assert read_secrets(path) == {"north": "a:b"}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('ok = "a:b"\nnorth = s3cret\n', "line 2: expected lines like"),
        ('north = "s3cret"\n', 'expected "user:password", found something else'),
        ("north = 5\n", "found something else"),
        ('[s3cret]\nx = "a:b"\n', "found something else"),
        (f'north = "me:{"s3cret" * 30}"\n', "longer than what can be sent"),
        ("#" + "s3cret" * 20000, "larger than 64 KiB"),
    ],
)
def test_wrong_secrets_are_told_and_never_shown(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(ConfigError) as caught:
        find_login("north", secrets_file(tmp_path, text), {})
    assert told in str(caught.value)
    assert "s3cret" not in str(caught.value).replace("'s3cret' in", "")


def test_a_key_is_all_of_the_value(tmp_path: Path) -> None:
    path = secrets_file(tmp_path, 'desk = "a key"\n')
    assert find_key("desk", path, {}) == "a key"
    assert find_key("desk", path, {"TRECSIM_CREDENTIALS_DESK": "a:b"}) == "a:b"
    with pytest.raises(ConfigError, match="found nothing"):
        find_key("desk", path, {"TRECSIM_CREDENTIALS_DESK": ""})


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"cannot read the secrets in .*: No such file"):
        read_secrets(tmp_path / "gone.toml")


def test_no_text_of_a_login_shows_it() -> None:
    assert "s3cret" not in repr(Login("admin", "s3cret"))
    assert "admin" not in str(Login("admin", "s3cret"))
