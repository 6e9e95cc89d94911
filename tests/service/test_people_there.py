"""People as events list them, with numbers that can be checked by hand."""

import json

import numpy as np

from trecsim.floor_points import ANKLES, HIPS
from trecsim.service.people_there import people_of
from trecsim.values import PROVISIONAL, Snapshot


def snapshot(**changes):
    xyz_m = np.full((1, 17, 3), np.nan)
    xyz_m[0, ANKLES] = [[1.0, 2.0, 0.1], [1.2, 2.4, 0.3]]
    xyz_m[0, HIPS] = [[3.0, 4.0, 0.9], [3.2, 4.0, 0.9]]
    cov_m2 = np.broadcast_to([[0.04, 0.01, 0.0], [0.01, 0.08, 0.0], [0, 0, 1]], (1, 17, 3, 3))
    velocity_mps = np.broadcast_to([0.6, 0.8, 5.0], (1, 17, 3))
    values = {"support": np.full((1, 17), 2), "state": np.array(["confirmed"]), **changes}
    return Snapshot(
        0.0, np.array([14]), xyz_m, cov_m2, values["support"], velocity_mps=velocity_mps,
        state=values["state"],
    )  # fmt: skip


def test_the_floor_point_is_the_mean_of_the_ankles_and_the_speed_that_of_the_hips():
    (found,) = people_of(snapshot())
    assert found == {
        "person": 14, "floor_m": [1.1, 2.2], "floor_cov_m2": [0.02, 0.005, 0.04],
        "speed_mps": 1.0, "posture": "upright",
    }  # fmt: skip


def test_one_ankle_counts_alone_and_without_any_the_hips_do():
    support = np.full((1, 17), 2)
    support[0, ANKLES[1]] = 0
    (found,) = people_of(snapshot(support=support))
    assert (found["floor_m"], found["floor_cov_m2"]) == ([1.0, 2.0], [0.04, 0.01, 0.08])
    support[0, ANKLES] = 0
    assert people_of(snapshot(support=support))[0]["floor_m"] == [3.1, 4.0]


def test_who_is_provisional_was_not_there_and_what_is_unknown_is_null():
    assert people_of(snapshot(state=np.array([PROVISIONAL]))) == []
    bare = snapshot()
    unknown = Snapshot(0.0, bare.id, np.full_like(bare.xyz_m, np.nan), bare.cov_m2, bare.support)
    (found,) = people_of(unknown)
    assert (found["floor_m"], found["speed_mps"]) == ([None, None], None)
    json.dumps(found, allow_nan=False)
