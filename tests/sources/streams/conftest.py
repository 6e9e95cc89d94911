"""Fixtures for the tests of live sources."""

from collections.abc import Iterator

import pytest

from made_cameras import MadeCamera


@pytest.fixture
def camera() -> Iterator[MadeCamera]:
    """Return a camera that is on."""
    made = MadeCamera()
    yield made
    made.close()
