import threading

import pytest

from trecsim.sources import prefetched


def prefetchers():
    return [thread for thread in threading.enumerate() if thread.name.startswith("prefetch")]


@pytest.fixture(autouse=True)
def no_thread_is_left():
    yield
    assert prefetchers() == []


@pytest.mark.parametrize("depth", [1, 2, 10])
@pytest.mark.parametrize("n", [0, 1, 50])
def test_items_come_in_order_and_all(n, depth):
    assert list(prefetched(iter(range(n)), depth)) == list(range(n))


def test_none_is_an_item_like_others():
    assert list(prefetched([None, None])) == [None, None]


def test_an_error_comes_where_its_item_would_have_come():
    def failing():
        yield 1
        yield 2
        raise ValueError("broken")

    items = prefetched(failing(), 3)
    assert next(items) == 1
    assert next(items) == 2
    with pytest.raises(ValueError, match="broken"):
        next(items)


def test_no_more_is_made_ahead_than_asked():
    made = []

    def making():
        for index in range(100):
            made.append(index)
            yield index

    items = prefetched(making(), depth=3)
    for expected in range(20):
        assert next(items) == expected
        assert len(made) <= expected + 5
    items.close()


def test_closing_early_ends_the_thread_and_closes_the_source():
    closed = threading.Event()

    def endless():
        try:
            while True:
                yield 0
        finally:
            closed.set()

    items = prefetched(endless())
    next(items)
    assert prefetchers()
    items.close()
    assert prefetchers() == []
    assert closed.is_set()


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError])
def test_an_interrupt_in_the_loop_ends_the_thread(error):
    def consume():
        for item in prefetched(iter(range(1000))):
            if item == 5:
                raise error

    with pytest.raises(error):
        consume()


def test_an_interrupt_while_waiting_for_an_item_ends_the_thread(monkeypatch):
    gate = threading.Event()

    def slow():
        yield 1
        gate.wait(10)
        yield 2

    def interrupted(self, timeout=None):
        gate.set()
        raise KeyboardInterrupt

    items = prefetched(slow())
    next(items)
    monkeypatch.setattr("concurrent.futures.Future.result", interrupted)
    with pytest.raises(KeyboardInterrupt):
        next(items)
    assert prefetchers() == []


def test_a_generator_never_asked_starts_no_thread():
    prefetched(range(3))
    assert prefetchers() == []
