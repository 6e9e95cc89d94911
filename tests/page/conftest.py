"""One page process for the tests that leave it as it is, and one Chromium."""

from collections.abc import Iterator

import pytest

from made_browser import chromium
from made_page import RunningPage, running_page

__all__ = ["chromium"]  # a fixture: one for all files, as Playwright starts once in a process


@pytest.fixture(scope="session")
def page() -> Iterator[RunningPage]:
    with running_page() as page:
        yield page
