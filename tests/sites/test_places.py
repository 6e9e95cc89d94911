"""Zones, lines and edges of a site file."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from trecsim.sites.places import EdgeTable, LineTable, TimeZone, ZoneTable, crossing_sides

SQUARE = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]


def refused(table, **keys):
    with pytest.raises(ValidationError) as caught:
        table.model_validate(keys)
    return str(caught.value)


def test_a_zone_reaches_from_the_floor_to_2_5_m_unless_it_says_otherwise():
    assert ZoneTable.model_validate({"polygon_m": SQUARE}).z_m == (0.0, 2.5)


@pytest.mark.parametrize(
    ("keys", "why"),
    [
        ({"polygon_m": SQUARE[:2]}, "at least 3"),
        ({"polygon_m": SQUARE, "z_m": [2.0, 1.0]}, r"expected \[low, high\], found \[2, 1\]"),
        ({"polygon_m": SQUARE, "z_m": [1.0, 1.0]}, "expected"),
        ({"polygon_m": [SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]]}, "sides 1 and 3 cross"),
        ({"polygon_m": [*SQUARE[:3], SQUARE[2]]}, "cross"),
        ({"polygon_m": [[0.0, 0.0], [np.nan, 1.0], [1.0, 1.0]]}, "polygon_m"),
        ({"polygon_m": [[0.0, 0.0], [1e9, 1.0], [1.0, 1.0]]}, "polygon_m"),
    ],
)
def test_a_zone_that_cannot_be_is_refused_with_the_reason(keys, why):
    import re

    assert re.search(why, refused(ZoneTable, **keys))


def test_lines_and_edges_need_points_that_differ():
    assert "points 2 and 3" in refused(EdgeTable, points_m=[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]])
    assert "points 1 and 2" in refused(LineTable, points_m=[[1.0, 0.0], [1.0, 0.0]])
    assert "at most 2" in refused(LineTable, points_m=SQUARE)


@pytest.mark.parametrize("name", ["Europe/Zurich", "UTC", "America/New_York"])
def test_a_time_zone_has_an_iana_name(name):
    assert TypeAdapter(TimeZone).validate_python(name) == name


@pytest.mark.parametrize(
    "name", ["", "Mars/Olympus", "../../etc/passwd", "/etc/localtime", "Europe"]
)
def test_what_is_no_time_zone_is_refused(name):
    with pytest.raises(ValidationError, match="IANA"):
        TypeAdapter(TimeZone).validate_python(name)


@given(st.integers(3, 12), st.integers(0, 2**32 - 1))
def test_a_star_shaped_polygon_has_no_crossing_sides_and_one_with_swapped_corners_may(n, seed):
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0.0, 2 * np.pi, n))
    gaps = np.diff(np.r_[angles, angles[0] + 2 * np.pi])
    if gaps.min() < 1e-3 or gaps.max() > np.pi - 1e-3:
        return
    radii = rng.uniform(0.5, 2.0, n)
    corners = list(zip(radii * np.cos(angles), radii * np.sin(angles), strict=True))
    assert crossing_sides(corners) is None
    if n >= 4:
        corners[0], corners[1] = corners[1], corners[0]
        convex = np.allclose(radii, radii[0])
        assert not convex or crossing_sides(corners) is not None
