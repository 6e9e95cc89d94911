"""Limb lengths: the fourteen of the thesis, and what must not change them."""

import numpy as np
import pytest

from made_people import STANDING_M, snapshots, track
from trecsim.errors import ConfigError
from trecsim.lab.evaluation.limbs import (
    LIMBS,
    limb_lengths,
    limb_named,
    limb_series,
    limb_summary,
    limb_table,
    true_lengths,
)
from trecsim.lab.evaluation.measured import read_measured
from trecsim.lab.evaluation.moments import gather
from trecsim.lab.evaluation.person_tracks import people_of, pieces
from trecsim.skeleton import COCO17
from trecsim.store.truth import Truth

TIMES_S = np.arange(5) * 0.04


def test_the_lengths_of_somebody_known():
    length_cm = dict(zip(LIMBS, 100 * limb_lengths(STANDING_M), strict=True))
    assert length_cm == pytest.approx(
        {
            "nose - right shoulder": 100 * np.sqrt(0.1**2 + 0.18**2 + 0.2**2),
            "nose - left shoulder": 100 * np.sqrt(0.1**2 + 0.18**2 + 0.2**2),
            "shoulder width": 36,
            "right upper arm": 30,
            "left upper arm": 30,
            "right forearm": 25,
            "left forearm": 25,
            "right trunk": 100 * np.sqrt(0.08**2 + 0.5**2),
            "left trunk": 100 * np.sqrt(0.08**2 + 0.5**2),
            "pelvis width": 20,
            "right thigh": 42,
            "left thigh": 42,
            "right shin": 40,
            "left shin": 40,
        }
    )


def test_each_limb_has_the_ends_it_is_named_after():
    for index, limb in enumerate(LIMBS):
        for joint in range(17):
            moved_m = STANDING_M.copy()
            moved_m[joint] += [0.05, 0.03, 0.02]
            changed = abs(limb_lengths(moved_m) - limb_lengths(STANDING_M))[index] > 1e-6
            side = COCO17.joints[joint].split("_")[0]
            if side in ("left", "right") and limb.startswith(("left", "right")):
                assert not changed or limb.startswith(side)


def test_rigid_motion_changes_no_length():
    rng = np.random.default_rng(3)
    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    bodies_m = STANDING_M + rng.normal(0, 0.1, (20, 17, 3))
    np.testing.assert_allclose(limb_lengths(bodies_m @ R.T + 5.0), limb_lengths(bodies_m))


def test_mean_and_deviation_count_supported_moments_only():
    one = track(4, TIMES_S)
    knee, ankle = COCO17.index("left_knee"), COCO17.index("left_ankle")
    one.xyz_m[:, ankle, 2] = 0.48 - np.array([0.39, 0.41, 0.39, 0.41, 0.80])
    one.support[4, ankle] = 0  # the last is carried along, and drifts
    one.xyz_m[0, knee] = np.nan
    given = {4: np.full(len(LIMBS), 0.5)}
    row = next(r for r in limb_table(limb_series([one]), given) if r.limb == "left shin")
    assert row.n == 3
    assert row.mean_m == pytest.approx((0.41 + 0.39 + 0.41) / 3)
    assert row.sd_m == pytest.approx(np.std([0.41, 0.39, 0.41]))
    assert row.difference_m == pytest.approx(row.mean_m - 0.5)
    assert row.row()["difference_percent"] == pytest.approx(200 * (row.mean_m - 0.5))
    unknown = next(r for r in limb_table(limb_series([one])) if r.limb == "left shin")
    assert np.isnan(unknown.difference_m)


def test_a_limb_that_was_never_supported_has_no_length():
    rows = limb_table(limb_series([track(0, TIMES_S, support=0)]))
    assert {row.n for row in rows} == {0}
    assert all(np.isnan(row.mean_m) and np.isnan(row.sd_m) for row in rows)
    assert np.isnan(limb_summary(rows).sd_m)
    assert limb_summary(rows).people == 0


def test_the_summary_weighs_by_moments():
    short, long = track(0, TIMES_S[:2]), track(1, TIMES_S)
    short.xyz_m[:, COCO17.index("left_ankle"), 2] += [0.1, -0.1]  # sd 0.1 over two moments
    summary = limb_summary(limb_table(limb_series([short, long])))
    assert summary.people == 2
    assert summary.sd_m == pytest.approx(0.1 * 2 / (14 * 2 + 14 * 5))


def test_true_lengths_are_those_of_the_person_followed():
    small, large = STANDING_M * 0.9, STANDING_M * 1.1
    beside_m = np.array([2.0, 0.0, 0.0])
    truth = Truth(TIMES_S, np.array([[small] * 5, [large + beside_m] * 5]))
    people = [
        track(7, TIMES_S + 0.01, np.array([large + beside_m + 0.02] * 5)),
        track(8, TIMES_S[:2], np.array([small] * 2)),
        track(9, TIMES_S, np.array([small + np.array([0.0, 0.0, 0.51])] * 5)),
    ]
    given = true_lengths(people, truth)
    assert sorted(given) == [7, 8]
    np.testing.assert_allclose(given[7], 1.1 * limb_lengths(STANDING_M))
    np.testing.assert_allclose(given[8], 0.9 * limb_lengths(STANDING_M))


def test_people_come_out_of_moments_as_they_went_in():
    walk_m = np.array([STANDING_M + np.array([x, 0, 0]) for x in TIMES_S])
    people = [track(9, TIMES_S[1:4]), track(2, TIMES_S, walk_m, support=1)]
    people[0].xyz_m[1, 3] = np.nan
    found = people_of(gather(snapshots(people)))
    assert [one.person for one in found] == [2, 9]
    for one, other in zip(found, people[::-1], strict=True):
        np.testing.assert_array_equal(one.t_s, other.t_s)
        np.testing.assert_array_equal(one.xyz_m, other.xyz_m)
        np.testing.assert_array_equal(one.support, other.support)


def test_nobody_has_no_track():
    assert people_of(gather([])) == ()


def test_a_gap_begins_a_new_piece():
    assert pieces(np.array([0.0, 1.0, 2.4, 4.0]), 1.0).tolist() == [0, 0, 0, 1]


MEASURED = """
format = "trecsim.limbs/1"
[subjects.anna]
people = [3, 8]
lengths_cm = { "shoulder line" = 40, "left shin" = 41.5 }
[subjects.bert]
people = [4]
lengths_cm = {}
"""


@pytest.mark.parametrize(
    ("written", "limb"),
    [
        *((limb, limb) for limb in LIMBS),
        ("left brachium", "left upper arm"),
        ("left humerus", "left upper arm"),
        ("Right Antebrachium", "right forearm"),
        ("r_tibia", "right shin"),
        ("left flank", "left trunk"),
        ("shoulder line", "shoulder width"),
        ("waist", "pelvis width"),
        ("pelvis-width", "pelvis width"),
        ("humerus", None),
        ("left nose", None),
    ],
)
def test_a_limb_is_known_by_its_common_names(written, limb):
    assert limb_named(written) == limb


def test_measured_lengths_go_to_every_identity_of_a_subject(tmp_path):
    path = tmp_path / "measured.toml"
    path.write_text(MEASURED)
    given = read_measured(path)
    assert sorted(given) == [3, 4, 8]
    assert given[8][LIMBS.index("shoulder width")] == pytest.approx(0.40)
    assert given[3][LIMBS.index("left shin")] == pytest.approx(0.415)
    assert np.isfinite(given[3]).sum() == 2
    assert np.isnan(given[4]).all()


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"left shin" = 41.5', '"left shin" = -1', "greater than 0"),
        ('"left shin" = 41.5', '"left shin" = nan', "finite"),
        ('"left shin" = 41.5', '"left shine" = 41.5', "did you mean 'left shin'"),
        ('"left shin" = 41.5', '"shoulders" = 41.5', "the same limb as 'shoulder line'"),
        ("[4]", "[8]", "line 7: subjects.bert.people: identity 8 is also that of 'anna'"),
        ("[4]", "[-4]", "greater than or equal to 0"),
        ("trecsim.limbs/1", "trecsim.limbs/9", "trecsim.limbs/1"),
    ],
)
def test_faults_of_measured_lengths_are_told(tmp_path, old, new, told):
    path = tmp_path / "measured.toml"
    path.write_text(MEASURED.replace(old, new))
    with pytest.raises(ConfigError, match="line"):
        read_measured(path)
    with pytest.raises(ConfigError) as caught:
        read_measured(path)
    assert told in str(caught.value)
