"""A cloud of joints in a room of four cameras, and its key points, for tests of the kernels."""

import numpy as np

import reference_fusion as reference
from trecsim.fusion import kernels
from trecsim.fusion.model import build
from trecsim.fusion.settings import FusionSettings
from trecsim.lab.simulation.room import corner_rig
from trecsim.skeleton import COCO17

SETTINGS = FusionSettings()
MODEL = build(corner_rig(6.0, 5.0, 2.6, cameras=4), COCO17, SETTINGS)


def somebody(rng):
    """Draw joints in the middle of the room, and their covariance."""
    xyz = rng.normal([0, 0, 1.0], [0.5, 0.5, 0.4], (17, 3))
    A = rng.normal(0, 0.03, (17, 3, 3))
    return xyz, A @ A.swapaxes(1, 2) + 1e-5 * np.eye(3)


NO_CHAIN = np.empty((0, 3), np.int64)


def limbs_of(pairs, slack_m2=0.0, n_joint=None, chain=NO_CHAIN):
    """Return limbs between pairs of joints."""
    pairs = np.array(pairs, np.int64).reshape(-1, 2)
    n_joint = pairs.max() + 1 if n_joint is None else n_joint
    return kernels.Limbs(
        pairs, np.full(len(pairs), slack_m2), np.zeros(n_joint), np.array(chain, np.int64)
    )


def fitted(*shape):
    """Return room for how the key points of (track, view, joint) fit."""
    return kernels.Fitted(
        np.zeros(shape), np.zeros((*shape, 2)), np.zeros((*shape, 2)), np.zeros(shape),
        np.zeros(shape),
    )  # fmt: skip


def seen(rng, P, xyz, spread_px=8.0):
    """Draw key points, a fifth of them missing, and their factors of uncertainty."""
    xy = np.array([reference.project(P, x) for x in xyz]) + rng.normal(0, spread_px, (17, 2))
    xy[rng.random(17) < 0.2] = np.nan
    return xy, rng.uniform(1.0, 6.0, 17)
