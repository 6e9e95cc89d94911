"""When a lost camera is tried again."""

from trecsim.sources.streams.retrying import Retrying


def waits(retrying: Retrying, until_s: float, tries_s: float = 0.0) -> list[tuple[float, float]]:
    """Return when each wait began and how long it was, of a camera that never comes back."""
    now_s, found = 0.0, []
    while now_s < until_s:
        wait_s = retrying.delay_s(now_s)
        found.append((now_s, wait_s))
        now_s += wait_s + tries_s
    return found


def test_it_is_tried_again_soon_and_within_5_s_during_the_first_minute() -> None:
    for camera in ("north", "south", "east", "west"):
        found = waits(Retrying(camera), 600.0)
        assert found[0][1] < 0.7
        assert all(wait_s <= 5.0 for since_s, wait_s in found if since_s <= 60.0)
        assert all(wait_s <= 30.0 for _, wait_s in found)
        assert found[-1][1] > 15.0


def test_two_cameras_do_not_come_at_the_same_moment() -> None:
    north, south = waits(Retrying("north"), 60.0), waits(Retrying("south"), 60.0)
    assert {since_s for since_s, _ in north[1:]}.isdisjoint(since_s for since_s, _ in south[1:])


def test_after_it_was_there_it_is_tried_at_once_again() -> None:
    retrying = Retrying("north")
    waits(retrying, 600.0)
    retrying.connected()
    assert retrying.delay_s(700.0) < 0.7
    assert all(wait_s <= 5.0 for _, wait_s in [(0.0, retrying.delay_s(701.0))] * 3)


def test_a_wrong_password_is_not_tried_often() -> None:
    assert Retrying("north").delay_s(0.0, refused=True) == 30.0
