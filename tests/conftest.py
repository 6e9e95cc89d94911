"""Fixtures for all tests."""

from pathlib import Path

import pytest
from hypothesis import settings

# Machines are shared and kernels compile at their first call: time says nothing about a law.
settings.register_profile("trecsim", deadline=None)
settings.load_profile("trecsim")


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Return the folder of test data beside the repository, or skip."""
    folder = Path(__file__).resolve().parents[2] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"test data is not there: {folder.name} beside the repository")
    return folder
