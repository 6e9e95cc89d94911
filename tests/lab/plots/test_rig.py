import dataclasses
from itertools import combinations

import numpy as np
import pytest

from made_rigs import K_1080P, camera, look_at, ring
from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.lab.plots.canvas import save_figure
from trecsim.lab.plots.rig_plot import floor_views, rig_figure


def above(x_m, height_m=4.0):
    T = look_at(np.array([x_m, 0.0, height_m]), np.array([x_m, 0.0, 0.0]), up=(0.0, 1.0, 0.0))
    K = np.array([[960.0, 0.0, 959.5], [0.0, 960.0, 539.5], [0.0, 0.0, 1.0]])
    return Camera(f"above {x_m:g}", (1920, 1080), K, T)


def crowded():
    """Return cameras that hang so close together that their names have no room beside them."""
    cameras = [
        Camera(
            f"a long name {i}",
            (1920, 1080),
            K_1080P,
            look_at(np.array([3 + 0.02 * i, 0.03 * i, 2.5]), np.array([0.0, i - 4.0, 1.0])),
        )
        for i in range(9)
    ]
    return Rig((*cameras, above(0.0)))


def test_the_area_seen_by_two_cameras_is_the_overlap_of_their_rectangles():
    # Each sees 8 m x 4.5 m from 4 m above, the second one 2 m further along x.
    views = floor_views(Rig((above(0.0), above(2.0))))
    assert views.range_m == 8.0
    assert views.shared_m2 == pytest.approx(6.0 * 4.5, rel=0.02)


def test_views_end_at_the_range_and_hold_the_cameras():
    rig = ring(4)
    views = floor_views(rig)
    for cam, margin in zip(rig, views.margin, strict=True):
        y, x = np.nonzero(margin > 0)
        away_m = np.hypot(views.x_m[x] - cam.position_m[0], views.y_m[y] - cam.position_m[1])
        assert 0.9 * views.range_m < away_m.max() < views.range_m
        assert views.x_m[0] < cam.position_m[0] < views.x_m[-1]
        assert views.y_m[0] < cam.position_m[1] < views.y_m[-1]


def drawn_labels(figure):
    axes = figure.axes[0]
    figure.draw_without_rendering()
    return axes, [text for text in axes.texts if text.get_text() not in ("", "x", "y")]


@pytest.mark.parametrize("rig", [ring(3), ring(12, "brown", 12.0), crowded()])
def test_names_and_heights_stand_in_the_picture_and_do_not_overlap(rig):
    axes, labels = drawn_labels(rig_figure(rig, "a rig"))
    assert [label.get_text() for label in labels] == [
        f"{cam.name}\n{cam.position_m[2]:.2f} m high" for cam in rig
    ]
    boxes = [label.get_window_extent() for label in labels]
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))
    frame = axes.get_window_extent()
    assert all(frame.x0 <= box.x0 and box.x1 <= frame.x1 for box in boxes)
    assert all(frame.y0 <= box.y0 and box.y1 <= frame.y1 for box in boxes)


def test_the_title_says_how_far_and_how_much_is_shared():
    figure = rig_figure(Rig((above(0.0), above(2.0))), "hall")
    title = figure.axes[0].get_title()
    assert title.splitlines() == [
        "hall",
        "2 cameras and the floor they see, up to 8 m away",
        "27 m² are seen by two or more",
    ]


@pytest.mark.parametrize(
    "rig",
    [
        Rig((camera(),)),
        Rig((camera(position_m=(0, 0, -3), target_m=(5, 0, -3)),)),
        Rig((camera(position_m=(0, 0, 2), target_m=(0, 1e-3, 50)),)),
        Rig((camera("a"), camera("b"))),
        Rig((camera("a"), camera("b", position_m=(9e5, 0, 2), target_m=(0, 0, 0)))),
        Rig((dataclasses.replace(camera(), name="$x^{$ 北"),)),
    ],
    ids=["one", "below the floor", "looking up", "same place", "very far", "odd name"],
)
def test_odd_rigs_are_drawn_too(rig, tmp_path):
    save_figure(rig_figure(rig), tmp_path / "rig.png")
    assert (tmp_path / "rig.png").stat().st_size > 5000


def test_the_shades_say_how_many_cameras_see_the_floor():
    (legend,) = rig_figure(ring(4)).legends
    assert [text.get_text() for text in legend.get_texts()] == ["1", "2", "3", "4"]
    (legend,) = rig_figure(ring(12, "brown", 12.0)).legends
    assert legend.get_texts()[-1].get_text().endswith(" or more")
    assert "lower edge of its image" in legend.get_title().get_text()
