"""Images in frame sets, or each by itself as it arrives: the same people in the same places."""

import numpy as np
import pytest

from fusion.made import frame_sets, made, outcome, path
from trecsim.fusion import Tracker
from trecsim.values import FrameSet

PATHS = [
    path((0, -2, 0), (5, 2, 0)),
    path((0, 2, 1.5), (5, -2, 1.2)),
    path((2, -1, -2), (5, 1.5, -1.5)),
]
SETTLED = 25


@pytest.fixture(scope="module", params=[(4, True), (4, False), (2, True)])
def both(request):
    """Return a scene, and its snapshots for each frame set by both ways."""
    cameras, stagger = request.param
    scene = made(PATHS, cameras=cameras, seconds=5.0, stagger=stagger)
    together, apart = Tracker(scene.rig), Tracker(scene.rig)
    pairs = []
    for s in frame_sets(scene):
        one = together.step(s)
        for view in sorted(s.views, key=lambda view: view.t_s):
            other = apart.step(FrameSet(view.t_s, (view,)))
        pairs.append((one, other))
    return scene, *zip(*pairs, strict=True)


def test_the_same_people_are_there_at_the_same_times(both):
    _, together, apart = both
    differ = sum(one.id.tolist() != other.id.tolist() for one, other in zip(together, apart,
                 strict=True))  # fmt: skip
    assert differ <= 2
    assert together[-1].id.tolist() == apart[-1].id.tolist() == [0, 1, 2]
    assert all(one.t_s == other.t_s for one, other in zip(together, apart, strict=True))


def test_their_joints_lie_within_what_noise_leaves_open(both):
    _, together, apart = both
    off_m = np.concatenate(
        [
            np.linalg.norm(one.xyz_m - other.xyz_m, axis=-1).ravel()
            for one, other in zip(together[SETTLED:], apart[SETTLED:], strict=True)
            if len(one.id) == len(other.id)
        ]
    )
    assert np.median(off_m) < 0.006
    assert np.quantile(off_m, 0.95) < 0.07  # joints that one of two cameras sees


def test_neither_is_closer_to_the_truth(both):
    scene, *ways = both
    error_m = [np.nanmedian(outcome(scene, list(way)).error_m[SETTLED:]) for way in ways]
    assert error_m[1] == pytest.approx(error_m[0], rel=0.12)


def test_the_stated_uncertainty_is_the_same(both):
    _, together, apart = both
    sigma_m = [np.median([s.sigma_m.mean() for s in way[SETTLED:]]) for way in (together, apart)]
    assert sigma_m[1] == pytest.approx(sigma_m[0], rel=0.15)
