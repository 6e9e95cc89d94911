"""The files with which a site becomes a service."""

import shutil
import subprocess
from pathlib import Path

import pytest

DEPLOY = Path(__file__).resolve().parents[2] / "deploy"


def test_systemd_accepts_the_unit(tmp_path: Path) -> None:
    if shutil.which("systemd-analyze") is None:
        pytest.skip("systemd-analyze is not installed")
    unit = tmp_path / "trecsim@hall.service"
    text = (DEPLOY / "trecsim@.service").read_text()
    unit.write_text(text.replace("/opt/trecsim/bin/trecsim", "/bin/true"))
    command = ["systemd-analyze", "verify", "--man=no", str(unit)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    told = [line for line in (done.stdout + done.stderr).splitlines() if "trecsim@hall" in line]
    assert (done.returncode, told) == (0, [])


def test_the_unit_restarts_what_crashes_but_not_a_wrong_site_file() -> None:
    text = (DEPLOY / "trecsim@.service").read_text().splitlines()
    assert {"Type=notify", "Restart=always", "RestartPreventExitStatus=2"} <= set(text)
    assert "ExecReload=/bin/kill -HUP $MAINPID" in text


def test_the_container_runs_without_root() -> None:
    lines = (DEPLOY / "Containerfile").read_text().splitlines()
    last_stage = lines[max(n for n, line in enumerate(lines) if line.startswith("FROM ")) :]
    assert "USER trecsim" in last_stage
    assert 'ENTRYPOINT ["/opt/trecsim/bin/trecsim"]' in last_stage
