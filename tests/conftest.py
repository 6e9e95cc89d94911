"""Fixtures for all tests."""

import math
import os
from pathlib import Path
from typing import IO

import pytest
from hypothesis import settings

import shape_checker
from often import DAILY, NIGHTLY, is_nightly

# Machines are shared and kernels compile at their first call: time says nothing about a law.
# Examples are the same in every run, so that a change alone decides whether tests pass; nightly
# runs (`make test-random`) draw others, and more of them, and print how to repeat what fails.
settings.register_profile(
    "repeatable", deadline=None, derandomize=True, print_blob=True, max_examples=DAILY
)
settings.register_profile("random", deadline=None, print_blob=True, max_examples=NIGHTLY)
settings.load_profile("repeatable")


@pytest.hookimpl(optionalhook=True)  # of pytest-xdist, for --numprocesses=auto
def pytest_xdist_auto_num_workers() -> int:
    """Run one process more than there are processors: many tests wait most of their time."""
    return (os.cpu_count() or 1) + 1


SHAPE_CHECKS = 2000  # of each test; nightly runs make them all


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup() -> None:
    """Check the shapes of the first calls of a test, its fixtures included."""
    shape_checker.allow(math.inf if is_nightly() else SHAPE_CHECKS)


collect_ignore = [
    "servers",  # run by the system's Python, which has GStreamer
    "export/blender_reader.py",  # run by Blender
]


@pytest.fixture
def blank_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave the figures of a page blank: to draw them takes longer than all the rest."""

    def savefig(_: object, file: IO[bytes], **__: object) -> None:
        file.write(b'<svg viewBox="0 0 1 1"></svg>')

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", savefig)


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Return the folder of test data beside the repository, or skip."""
    folder = Path(__file__).resolve().parents[2] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"test data is not there: {folder.name} beside the repository")
    return folder
