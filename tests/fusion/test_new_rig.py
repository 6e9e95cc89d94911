"""A tracker that goes on with cameras calibrated anew."""

from dataclasses import replace

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.lab.simulation import room_scene, simulate
from trecsim.lab.simulation.failures import Knock
from trecsim.tracking import Follower

KNOCK = Knock("cam2", 0.0, turn_deg=(0.0, 1.5, 0.0))


@pytest.fixture(scope="module")
def made():
    return simulate(replace(room_scene(people=2, seconds=8.0), knocks=(KNOCK,)), seed=4)


def true_rig(made):
    return Rig(tuple(KNOCK.moved(one) if one.name == "cam2" else one for one in made.rig))


def test_people_keep_their_identities_when_the_rig_is_put_right(made):
    follower, ids, late_m = Follower(made.rig), [], []
    for image in made.poses:
        if image.t_s > 5.0 and not late_m:
            follower.take_rig(true_rig(made))
        for snapshot in follower.add(image):
            ids.append(set(snapshot.confirmed().id.tolist()))
            if image.t_s > 5.0:
                at = int(np.argmin(np.abs(made.truth_t_s - snapshot.t_s)))
                gap_m = np.linalg.norm(
                    snapshot.xyz_m[:, None] - made.truth_xyz_m[None, :, at], axis=-1
                )
                late_m.append(float(np.nanmedian(gap_m, axis=-1).min(axis=1).max(initial=0.0)))
    before, after = set().union(*ids[60:120]), set().union(*ids[-40:])
    assert len(before) == 2
    assert after == before
    assert np.median(late_m[-40:]) < 0.06


def test_the_errors_learnt_of_the_old_rig_are_forgotten(made):
    follower = Follower(made.rig)
    for image in made.poses[:400]:
        list(follower.add(image))
    assert np.abs(follower._tracker.camera_errors.applied[1, :3]).max() > 1e-3
    follower.take_rig(true_rig(made))
    assert not follower._tracker.camera_errors.applied.any()


def test_other_cameras_are_refused(made):
    fewer = Rig(tuple(made.rig)[:2])
    with pytest.raises(InputError, match="expected the cameras"):
        Follower(made.rig).take_rig(fewer)
