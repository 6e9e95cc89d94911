"""Signed distances from lines and edges."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trecsim.safety.directed_lines import Edge, Line
from trecsim.safety.polygons import Polygon

BENT = Edge(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]]))  # turns to the left: over the drop


def test_left_of_a_line_is_positive_and_the_share_counts_along_it() -> None:
    line = Line(np.array([[1.0, 1.0], [1.0, 3.0]]))
    places = np.array([[0.0, 1.0], [2.5, 4.0]])
    np.testing.assert_allclose(line.distance_m(places), [1.0, -1.5])
    np.testing.assert_allclose(line.share(places), [0.0, 1.5])


@pytest.mark.parametrize(
    ("place", "distance_m"),
    [
        ((2.0, -0.3), 0.3),
        ((2.0, 0.3), -0.3),
        ((4.4, 2.0), 0.4),
        ((3.7, 3.0), -0.3),
        ((4.3, -0.4), 0.5),  # around the corner, nearest to the corner itself
        ((3.9, 0.2), -0.1),
        ((-0.5, -0.1), np.nan),
        ((4.2, 4.5), np.nan),
    ],
)
def test_right_of_an_edge_is_safe_left_is_the_drop_and_past_its_ends_is_neither(
    place: tuple[float, float], distance_m: float
) -> None:
    assert BENT.nearest(np.array([place]))[0][0] == pytest.approx(distance_m, nan_ok=True)


@given(st.floats(0.01, 4.9), st.floats(-0.9, 3.9))
def test_the_normal_of_an_edge_is_the_gradient_of_its_distance(x: float, y: float) -> None:
    step = 1e-6 * np.eye(2)
    here = np.array([[x, y]])
    distance_m, normal = BENT.nearest(here)
    if np.isnan(distance_m[0]) or abs(abs(x - 4) - abs(y)) < 1e-3 or abs(distance_m[0]) < 1e-3:
        return  # at an end, where two sides are equally near, or on the edge
    ahead, behind = BENT.nearest(here + step)[0], BENT.nearest(here - step)[0]
    np.testing.assert_allclose((ahead - behind) / 2e-6, normal[0], atol=1e-4)
    assert np.hypot(*normal[0]) == pytest.approx(1.0)


@given(st.floats(-1.0, 5.0), st.floats(-1.0, 3.0))
def test_the_normal_of_a_border_is_the_gradient_of_its_distance(x: float, y: float) -> None:
    square = Polygon(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
    sides_m = np.sort(np.abs([x, 4.0 - x, y, 2.0 - y]))
    if sides_m[1] - sides_m[0] < 1e-3 or sides_m[0] < 1e-3:
        return  # where two sides are equally near, or on the border
    here, step = np.array([[x, y]]), 1e-6 * np.eye(2)
    gradient = (square.distance_m(here + step) - square.distance_m(here - step)) / 2e-6
    np.testing.assert_allclose(square.normals(here)[0], gradient, atol=1e-4)
