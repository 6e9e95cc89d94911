"""What a picture keeps of a recording."""

import numpy as np

from made_tracks import snapshot, walk
from trecsim.lab.plots.path_recorder import MOST_POINTS, PathRecorder, floor_places


def test_a_path_keeps_ten_points_a_second_and_both_ends() -> None:
    recorder = PathRecorder()
    for moment in walk(251, people=1):
        recorder.add(moment)
    path = recorder.paths[0]
    assert (path.first_s, path.last_s) == (0.0, 10.0)
    assert len(path.points) == 84  # 25 moments a second: every third is kept


def test_a_long_path_takes_bounded_memory_and_keeps_its_shape() -> None:
    recorder = PathRecorder()
    for i in range(4 * MOST_POINTS):
        xyz_m = np.zeros((1, 17, 3))
        xyz_m[..., 0] = i / 10
        recorder.add(snapshot(i / 10, [0], xyz_m))
    points = np.array(recorder.paths[0].points)
    assert MOST_POINTS / 2 <= len(points) <= MOST_POINTS
    np.testing.assert_allclose(points[:, 0], points[:, 1])
    assert len(recorder.paths[0].pieces()) == 1


def test_somebody_who_was_away_has_a_path_in_two_pieces() -> None:
    recorder = PathRecorder()
    for t_s in (0.0, 0.2, 0.4, 5.0, 5.2):
        recorder.add(snapshot(t_s, [3]))
    assert [len(piece) for piece in recorder.paths[3].pieces()] == [3, 2]


def test_the_skeletons_are_of_the_moment_with_most_people() -> None:
    recorder = PathRecorder()
    for t_s, people in ((0.0, [1]), (1.0, [1, 2, 3]), (2.0, [1, 2])):
        recorder.add(snapshot(t_s, people))
    assert recorder.fullest is not None
    assert recorder.fullest.t_s == 1.0


def test_unknown_joints_do_not_hide_where_somebody_stands() -> None:
    xyz_m = np.ones((2, 17, 3))
    xyz_m[0, 3:] = np.nan
    xyz_m[1] = np.nan
    places_m = floor_places(xyz_m)
    np.testing.assert_array_equal(places_m, [[1.0, 1.0], [np.nan, np.nan]])
    recorder = PathRecorder()
    recorder.add(snapshot(0.0, [1, 2], xyz_m))
    assert list(recorder.paths) == [1]


def test_of_the_last_while_every_point_is_kept_and_of_those_who_left_before_none() -> None:
    recorder = PathRecorder(keep_s=60.0)
    for i in range(4600):
        person = 0 if i < 300 else 1 if i < 4500 else 2
        recorder.add(snapshot(i / 10, [person]))
    assert len(recorder.paths[1].points) < 3000  # the whole path has them further apart
    shown = recorder.shown()
    assert list(shown) == [1, 2]
    times_s = [point[0] for path in shown.values() for point in path.points]
    np.testing.assert_allclose(times_s, np.arange(4000 - 1, 4600) / 10)
    assert not recorder.paths[0].recent
