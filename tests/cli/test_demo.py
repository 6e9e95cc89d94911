"""The command `trecsim demo`."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from trecsim.cli import demo_command, first_run


def test_the_command_tells_what_came_of_it(
    trecsim: Callable[..., tuple[int, str, str]], tmp_path: Path
) -> None:
    small = ("--seconds", 3, "--people", 1, "--cameras", 2)
    code, out, _ = trecsim("demo", "--out", tmp_path / "a room", *small)
    assert code == 0
    assert f"picture: {tmp_path / 'a room' / 'paths.png'}" in out
    assert f"trecsim run '{tmp_path / 'a room' / 'site.toml'}'" in out
    code, out, err = trecsim("demo", "--out", tmp_path / "a room", *small, "--json")
    assert (code, err) == (0, "")
    facts = json.loads(out)
    assert facts["frame_sets"] == facts["truth"]["frames"] > 70
    assert facts["fusion_ms"]["median"] > 0
    code, out, err = trecsim("demo", "--out", tmp_path, *small)
    assert (code, out) == (2, "")
    assert "has not made" in err


def test_the_demo_advises_only_what_the_installed_extras_can_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def advised(*extras: str) -> str:
        monkeypatch.setattr(demo_command, "has_extra", lambda extra: extra in extras)
        return " ".join(demo_command._next_commands(Path("room")))

    assert "report" not in advised()
    assert "sample" not in advised("report")
    assert "trecsim report room" in advised("report", "video")
    assert "trecsim sample" in advised("report", "video")


@pytest.mark.parametrize(
    ("cached", "quiet", "told"), [(True, False, 0), (False, False, 1), (False, True, 0)]
)
def test_a_cold_cache_of_the_compiler_is_told_once(
    cached: bool,
    quiet: bool,
    told: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("trecsim.doctor.kernels_are_cached", lambda: cached)
    first_run.tell_first_run(quiet=quiet)
    assert capsys.readouterr().err.count("compiled once") == told
