"""Fixtures for the tests of estimators."""

from pathlib import Path

import pytest

from trecsim.estimators import store


@pytest.fixture(scope="session")
def movenet_file() -> Path:
    """Return the default model; it is fetched where it is not here yet."""
    pytest.importorskip("openvino")
    return store.pull("movenet")
