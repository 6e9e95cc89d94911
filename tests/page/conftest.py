"""One page process for the tests that leave it as it is."""

from collections.abc import Iterator

import pytest

from made_page import RunningPage, running_page


@pytest.fixture(scope="session")
def page() -> Iterator[RunningPage]:
    with running_page() as page:
        yield page
