"""The command `trecsim demo`."""

import json
from collections.abc import Callable
from pathlib import Path


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
