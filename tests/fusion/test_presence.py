"""Support, expectation and survival equal their twins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fusion.somebody import MODEL, fitted
from trecsim.fusion import kernels
from trecsim.fusion.kernels.presence import count_supported, second_newest, supporting
from trecsim.fusion.lifecycle import ON_TRIAL, look_back


def sightings(camera_s, two_view_s, joint_s=None, duration_s=None, mirrored_s=None):
    """Return the sightings of tracks; what is not given is nothing."""
    n = len(camera_s)
    joint_s = np.full((n, 4, camera_s.shape[1]), -np.inf) if joint_s is None else joint_s
    duration_s = np.zeros(n) if duration_s is None else duration_s
    mirrored_s = np.zeros(n) if mirrored_s is None else mirrored_s
    off, view_off = np.zeros(joint_s.shape), np.zeros((*camera_s.shape, 2))
    return kernels.Sightings(
        camera_s, joint_s, two_view_s, duration_s, mirrored_s, off, off.copy(), view_off
    )


def matched(match, flip=None):
    flip = np.zeros_like(match) if flip is None else flip
    return kernels.Matches(match, flip, np.ones(match.shape))


LOOK_BACK_S = np.full(3, 0.12)
LIMITS = kernels.Limits(confirm_s=0.15, death_s=0.5, single_view_death_s=1.5, duplicate_m=0.25)


def believed(n=1):
    """Return that nothing speaks against the tracks."""
    return kernels.Doubts(np.zeros(n), np.zeros(n), np.zeros((n, 17)))


SEEDS = st.integers(0, 2**32 - 1)


@pytest.mark.parametrize(
    ("sees", "missing", "duration_s", "confirmed"),
    [
        (2, 0, 0.15, True),
        (2, 0, 0.1, False),
        (2, 1, 0.15, False),  # a third camera looks at the place and sees nobody
        (2, 1, 0.25, True),
        (2, 2, 0.25, False),
        (2, 2, 0.45, True),
        (2, 3, 3.0, False),  # three against two
        (3, 0, 0.0, True),
        (3, 1, 0.0, True),
        (3, 2, 0.0, False),
        (3, 2, 0.2, True),
        (2, ON_TRIAL, 9.0, False),
    ],
)
def test_cameras_that_look_and_see_nobody_count_against_a_new_track(
    sees, missing, duration_s, confirmed
):
    camera_s = np.where(np.arange(3) < sees, 10.0, -np.inf)[None]
    out = np.zeros(1, bool)
    kernels.confirm_all(
        camera_s, np.array([duration_s]), np.array([missing]), 10.0, LOOK_BACK_S, 0.15, out
    )
    assert out[0] == confirmed


def test_a_camera_supports_whom_it_sees_with_three_joints_and_never_backwards_in_time():
    camera_s, joint_s = np.full((2, 3), -np.inf), np.full((2, 4, 3), -np.inf)
    fits = fitted(2, 2, 4)
    inlier = fits.inlier
    inlier[0, 0, :3], inlier[1, 0, :2] = 0.9, 0.9
    inlier[0, 1] = 0.4
    match = np.array([[0, 1], [1, -1]])
    matches, seen = matched(match), sightings(camera_s, np.zeros(2), joint_s)
    found = kernels.Measurements(
        np.array([2, 0]), np.array([0, 2, 2]), np.zeros((2, 4, 2)), np.ones((2, 4))
    )

    def note(first_s):
        taken = kernels.Taken(
            np.array([first_s, 6.0]),
            np.full(2, 0.04),
            np.full(3, 0.12),
            np.zeros(2),
            np.zeros(2, bool),
        )
        kernels.note_support(found, np.arange(4), taken, matches, fits, seen)

    note(5.0)
    assert camera_s[0].tolist() == [-np.inf, -np.inf, 5.0]
    assert joint_s[0, :, 2].tolist() == [5.0, 5.0, 5.0, -np.inf]
    assert (camera_s[1] == -np.inf).all()
    note(4.0)
    assert camera_s[0, 2] == 5.0
    assert joint_s[0, 0, 2] == 5.0


def test_time_with_two_cameras_and_time_read_mirrored_add_up():
    camera_s = np.array([[9.95, 9.9, 0.0], [10.0, 0.0, 0.0]])
    match, flip = np.array([[0, 1, 2], [3, -1, -1]]), np.array([[1, 1, 0], [0, 0, 0]])
    two_s, together_s, mirrored_s = np.array([1.0, 2.0]), np.zeros(2), np.array([0.1, 0.03])
    seen = sightings(camera_s, two_s, None, together_s, mirrored_s)
    before_s = np.array([9.86, 0.0])
    now = kernels.Now(10.0, 0.06, 0.0, 0.1, 0)
    kernels.age(seen, matched(match, flip), now, LOOK_BACK_S, before_s)
    assert two_s.tolist() == [10.0, 2.0]
    assert together_s == pytest.approx([0.04, 0.0])  # the second camera saw the first at 9.9 s
    assert mirrored_s == pytest.approx([0.1 + 0.02, 0.0])  # two of three; then less than nothing


def test_a_camera_with_few_images_supports_until_its_next_one_is_overdue():
    last_s = np.array([9.8, 9.8])
    slow, fast = look_back([0.2, 0.04]).look_back_s
    assert supporting(last_s, 10.0, np.array([slow, slow])) == 2
    assert supporting(last_s, 10.0, np.array([slow, fast])) == 1
    counts = np.empty((1, 1), np.int64)
    count_supported(last_s[None, None], 10.0, np.array([fast, slow]), counts)
    assert counts.tolist() == [[1]]


def test_the_second_newest_time_tells_until_when_two_cameras_saw_a_track():
    camera_s = np.array([[9.0, 10.0, 9.5], [-np.inf, 10.0, -np.inf], [7.0, 7.0, 1.0]])
    assert second_newest(camera_s).tolist() == [9.5, -np.inf, 7.0]


def test_time_that_passes_does_not_confirm_what_two_cameras_saw_once():
    """At 5 images per second a camera's support lasts longer than `confirm_s`."""
    look_back_s = look_back([0.2, 0.2]).look_back_s
    duration_s, seen_s = np.zeros(1), np.array([[9.8, 9.8]])
    seen = sightings(seen_s, np.array([9.8]), None, duration_s)
    missed = matched(np.full((1, 2), -1))
    kernels.age(seen, missed, kernels.Now(10.0, 0.2, 0.0, 0.1, 0), look_back_s, np.array([9.8]))
    assert duration_s.tolist() == [0.0]
    seen_s[:] = 10.0
    kernels.age(seen, missed, kernels.Now(10.0, 0.2, 0.0, 0.1, 0), look_back_s, np.array([9.8]))
    assert duration_s == pytest.approx([0.2])
    # Two single images a long time apart are not a long time.
    seen_s[:] = 12.0
    kernels.age(seen, missed, kernels.Now(12.0, 0.2, 0.0, 0.1, 0), look_back_s, np.array([10.0]))
    assert duration_s == pytest.approx([0.5])


@given(SEEDS, st.floats(0.05, 1.0))
def test_people_are_close_when_the_mean_distance_of_their_torsos_is(seed, distance_m):
    rng = np.random.default_rng(seed)
    x = rng.normal(0, 0.3, (3, 17, 3))
    apart = np.linalg.norm(x[:, None, MODEL.torso] - x[None, :, MODEL.torso], axis=-1).mean(-1)
    some = (apart[np.triu_indices(3, 1)] < distance_m).any()
    assert kernels.any_close(x, MODEL.torso, distance_m) == some


@pytest.mark.parametrize(
    ("last_s", "two_s", "confirmed", "expected", "lives"),
    [
        (9.6, 9.6, True, 2, True),  # seen within half a second
        (9.4, 9.4, True, 2, False),  # not seen for longer
        (9.6, 9.6, True, 1, True),
        (9.7, 9.7, True, 3, True),
        (9.6, 9.6, True, 3, False),  # that three cameras all miss somebody is rare
        (9.7, 9.7, True, 4, False),  # as many images as two cameras take in half a second
        (9.8, 9.8, True, 9, True),
        (9.6, 9.6, True, -1, True),  # others hide the person from all cameras
        (9.7, 9.7, True, 0, False),  # out of everybody's view for a quarter of a second
        (10.0, 8.0, True, 3, False),  # one camera against two that do not see the person
        (10.0, 8.0, True, 2, True),
        (10.0, 9.7, False, 2, False),  # tentative, and only one camera
        (10.0, 9.8, False, 2, True),
    ],
)
def test_who_lives_on(last_s, two_s, confirmed, expected, lives):
    seen = sightings(np.array([[last_s, -np.inf]]), np.array([two_s]))
    assert survives(seen, who(confirmed), expected) == lives


def who(confirmed=True, born_s=5.0, n=1):
    return kernels.Who(np.arange(n), np.full(n, born_s), np.full(n, confirmed))


def survives(seen, tracks, expected=2, leaving=False, look_back_s=LOOK_BACK_S, x_m=0.0):
    alive = np.empty(1, bool)
    all_alive = kernels.survive_all(
        seen, tracks, believed(), (np.array([expected]), np.array([leaving])),
        np.full((1, 17, 3), x_m), 10.0, look_back_s, LIMITS, alive,
    )  # fmt: skip
    assert alive[0] == all_alive
    return alive[0]


@pytest.mark.parametrize(("last_s", "lives"), [(9.76, True), (9.74, False)])
def test_whoever_was_leaving_is_given_up_within_a_quarter_of_a_second(last_s, lives):
    seen = sightings(np.array([[last_s, -np.inf]]), np.array([last_s]))
    assert survives(seen, who(), expected=2, leaving=True) == lives
    assert survives(seen, who(), expected=2)  # hidden where many look: as before


@pytest.mark.parametrize(("age_s", "lives"), [(0.35, True), (0.25, False), (0.0, False)])
def test_a_track_is_not_kept_for_longer_than_it_has_existed(age_s, lives):
    seen = sightings(np.array([[9.7, -np.inf]]), np.array([9.7]))
    assert survives(seen, who(born_s=9.7 - age_s)) == lives


def test_cameras_with_few_images_may_miss_one_before_a_track_is_given_up():
    seen = sightings(np.array([[9.72, -np.inf]]), np.array([9.72]))
    assert not survives(seen, who(), expected=4)
    assert survives(seen, who(), expected=4, look_back_s=np.full(3, 0.3))
    assert survives(seen, who(born_s=9.72), look_back_s=np.full(3, 0.3))


@pytest.mark.parametrize(
    ("last_s", "two_s", "asked"),
    [(10.0, 10.0, False), (9.8, 9.0, False), (9.7, 9.7, True), (10.0, 8.4, True)],
)
def test_where_somebody_should_be_seen_is_asked_only_of_those_whose_life_hangs_on_it(
    last_s, two_s, asked
):
    out = np.empty(1, bool)
    seen = sightings(np.array([[last_s, -np.inf]]), np.array([two_s]))
    some = kernels.ask_all(seen, 10.0, LIMITS, out)
    assert out[0] == asked
    assert some == asked


def test_a_body_that_is_not_finite_dies():
    seen = sightings(np.full((1, 2), 10.0), np.array([10.0]))
    assert survives(seen, who())
    assert not survives(seen, who(), x_m=np.inf)


def judged(camera_s, redundant_count, confirmed, n_compared):
    n = len(camera_s)
    x = np.zeros((n, 17, 3))
    x[:, :, 0] = 0.1 * np.arange(n)[:, None]
    asked, alive = np.empty(n, bool), np.empty(n, bool)
    told = kernels.judge_all(
        sightings(camera_s, np.full(n, 10.0)), who(n=n)._replace(confirmed=confirmed),
        kernels.Doubts(np.zeros(n), redundant_count, np.zeros((n, 17))), np.zeros(n, np.int64), x,
        MODEL.torso, n_compared, 10.0, LOOK_BACK_S[: camera_s.shape[1]], LIMITS, asked, alive,
    )  # fmt: skip
    return told, asked.tolist(), alive.tolist()


def test_tracks_are_judged_at_once_and_the_new_ones_are_no_duplicates():
    camera_s = np.array([[10.0, 10.0, 10.0], [10.0, 10.0, 9.0]])
    confirmed = np.zeros(2, bool)
    told, asked, alive = judged(camera_s, np.array([0.0, 3.0]), confirmed, 1)
    assert told == (False, False, False)
    assert confirmed.tolist() == [True, False]  # three cameras see the first
    assert asked == [False, False]
    assert alive == [True, False]  # others explain the second
    told, *_ = judged(camera_s, np.zeros(2), confirmed, 2)
    assert told == (True, False, True)


def test_whose_last_image_is_old_is_asked_for():
    told, asked, alive = judged(np.array([[9.7], [10.0]]), np.zeros(2), np.ones(2, bool), 0)
    assert told == (False, True, True)
    assert asked == [True, False]
    assert alive == [True, True]
