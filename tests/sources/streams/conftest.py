"""Fixtures for the tests of live sources."""

from collections.abc import Iterator

import pytest

from made_cameras import MadeCamera
from often import is_nightly
from trecsim.sources.streams import connection, retrying


@pytest.fixture
def camera() -> Iterator[MadeCamera]:
    """Return a camera that is on."""
    made = MadeCamera()
    yield made
    made.close()


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give a camera up, and try it again, after a third of the usual time; not in nightly runs."""
    if is_nightly():
        return
    for module, name in (
        *((connection, name) for name in ("SILENT_S", "NO_IMAGE_S", "NO_TIME_S")),
        *((retrying, name) for name in ("FIRST_S", "SOON_S")),
    ):
        monkeypatch.setattr(module, name, getattr(module, name) / 3.0)
