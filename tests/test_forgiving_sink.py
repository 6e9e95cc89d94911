"""A sink that fails stops nobody, and goes on when it can."""

import logging

import pytest

from trecsim.errors import SetupError
from trecsim.sinks import Forgiving
from trecsim.sinks.base import RETRY_S


class Disk:
    """A sink that is full for a while."""

    def __init__(self) -> None:
        self.full = False
        self.tries = 0
        self.taken: list[int] = []

    def write(self, item: int, /) -> None:
        self.tries += 1
        if self.full:
            raise SetupError("no room")
        self.taken.append(item)


def test_a_sink_that_failed_is_tried_again_and_goes_on(caplog: pytest.LogCaptureFixture) -> None:
    disk, now_s = Disk(), 0.0
    sink = Forgiving(disk, clock=lambda: now_s)
    with caplog.at_level(logging.WARNING):
        for second in range(60):
            now_s = float(second)
            disk.full = 5 <= second < 30
            sink.write(second)

    assert disk.taken == [0, 1, 2, 3, 4, *range(35, 60)]
    assert disk.tries == len(disk.taken) + 3
    assert [record.levelname for record in caplog.records] == ["ERROR", "WARNING"]
    assert f"tried again every {RETRY_S:g} s" in caplog.text
    assert "Disk can write again" in caplog.text


def test_an_error_of_another_kind_is_not_forgiven() -> None:
    class Broken:
        def write(self, item: int, /) -> None:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        Forgiving(Broken()).write(1)
