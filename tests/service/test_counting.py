"""Counts of people in zones and over lines while a site runs."""

import numpy as np
import pytest

from made_hall import BODY_M
from made_tracks import snapshot
from trecsim.health import Counts, LineCount, ZoneCount
from trecsim.service.counting import Counting
from trecsim.sites.recorded_site import RecordedSite

NOON_S = 1_796_036_400.0  # 2026-11-30 11:00 UTC, noon in Zurich
FEET_M = np.array([0.0, BODY_M[15:17, 1].mean(), 0.0])


def site(**places: object) -> RecordedSite:
    square = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]]
    tables = {
        "zones": {"hall": {"polygon_m": square}},
        "lines": {"gate": {"points_m": [[0.0, 3.0], [0.0, -3.0]]}},
    }
    given = {"format": "trecsim.site/1", "name": "hall", "timezone": "Europe/Zurich"}
    return RecordedSite.model_validate({**given, **tables, **places})


def walk(counting: Counting, t_s: float, xs_m: np.ndarray) -> None:
    """Let one person walk along x, ten moments a second."""
    for n, x in enumerate(xs_m):
        counting.write(snapshot(t_s + n / 10, [3], (BODY_M - FEET_M + [x, 0.0, 0.0])[None]))


def test_people_are_counted_in_zones_and_over_lines_by_direction() -> None:
    counting = Counting(site())
    walk(counting, NOON_S, np.linspace(-5.0, 1.0, 60))
    counts = counting.counts()
    assert counts.lines == {"gate": LineCount(inwards=1)}
    assert counts.zones == {"hall": ZoneCount(1, 0.062, "A")}
    assert counts.since_s == NOON_S
    walk(counting, NOON_S + 10, np.linspace(1.0, -5.0, 60))
    assert counting.counts().lines == {"gate": LineCount(1, 1)}
    assert counting.counts().zones == {"hall": ZoneCount(0, 0.0, "A")}


def test_crossings_begin_anew_at_midnight_of_the_site() -> None:
    counting = Counting(site())
    midnight_s = NOON_S + 12 * 3600.0
    walk(counting, midnight_s - 10.0, np.linspace(-1.0, 1.0, 60))
    assert counting.counts().lines["gate"].inwards == 1
    walk(counting, midnight_s + 1.0, np.linspace(1.0, 1.2, 5))
    assert counting.counts().lines["gate"] == LineCount()
    assert counting.counts().since_s == pytest.approx(midnight_s + 1.0)


def test_a_line_that_does_not_change_keeps_its_count_and_a_moved_one_begins_anew() -> None:
    counting = Counting(site())
    walk(counting, NOON_S, np.linspace(-1.0, 1.0, 60))
    counting.change(site(zones={}))
    assert counting.counts() == Counts(NOON_S, {}, {"gate": LineCount(1)})
    counting.change(site(lines={"gate": {"points_m": [[0.5, 3.0], [0.5, -3.0]]}}))
    assert counting.counts().lines == {"gate": LineCount()}


def test_a_zone_that_is_too_small_for_a_density_has_none() -> None:
    small = {"spot": {"polygon_m": [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]}}
    counting = Counting(site(zones=small))
    walk(counting, NOON_S, np.zeros(3))
    assert counting.counts().zones == {"spot": ZoneCount(1)}
