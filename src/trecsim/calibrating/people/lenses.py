"""Focal lengths and principal points refined, where parts of the recording confirm each other."""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool

from trecsim.calibrating.people.adjusting import LENS, Adjusted, adjusted, gained
from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.found import Found
from trecsim.calibrating.people.holding_out import halves
from trecsim.calibrating.people.observations import Observations
from trecsim.calibrating.people.pose_uncertainty import covariance_of
from trecsim.calibrating.people.priors import Priors
from trecsim.calibrating.people.tuning import LENS_EVIDENCE, LENS_LEAST, LENS_NAMED, LENS_SD
from trecsim.calibrating.people.variances import with_variances_of

FEWEST = 3  # two cameras explain wrong intrinsics by their poses


def with_lenses(found: Found, records: tuple[CameraRecord, ...]) -> Found:
    """Return what was found with refined intrinsics; as it is where the given ones are to be kept.

    Notes
    -----
    The evidence for other intrinsics must be clear: twice the logarithm of how many times likelier
    the recording is with them than with the given ones, their prior counted (Kass and Raftery).
    A wrong model of the people, as of a camera that moved, gives evidence, too. So the intrinsics
    found in each half of the recording must also explain the other half better than the given ones;
    else these are kept, and doubted.
    """
    n, known = len(found.priors.found), int(found.priors.found.sum())
    if known < FEWEST:
        return found
    priors = replace(found.priors, lens_sd=np.tile(LENS_SD, (n, 1)))
    start = found.rig.unknowns._replace(clock=np.zeros((n, 2)))
    rig = adjusted(found.seen, found.rig.state, priors, annealing=(1.0,), start=start)
    if evidence_for_lenses(rig, priors) < LENS_EVIDENCE:
        return found
    if not _holds_elsewhere(found, records, priors):
        return replace(found, doubts_lenses=True)
    return replace(found, rig=rig, priors=priors)


def evidence_for_lenses(rig: Adjusted, priors: Priors) -> float:
    """Return twice the log Bayes factor of refined intrinsics against the given ones (Laplace)."""
    assert priors.lens_sd is not None
    which = np.flatnonzero(priors.found)
    rows = (which[:, None] * priors.own + np.arange(LENS.start, LENS.stop)).ravel()
    precision = np.linalg.inv(covariance_of(rig, priors.own)[np.ix_(rows, rows)])
    lens, prior = rig.state.lens[which].ravel(), priors.lens_sd[which].ravel()
    _, logdet = np.linalg.slogdet(precision * np.outer(prior, prior))
    return float(lens @ precision @ lens - logdet)


def lenses_off(rig: Adjusted, own: int) -> Bool[np.ndarray, " cam"]:
    """Return of which cameras the intrinsics are clearly off."""
    sd = np.sqrt(np.diag(covariance_of(rig, own)).reshape(-1, own)[:, 8:])
    size = np.abs(rig.state.lens)
    off: Bool[np.ndarray, " cam"] = ((size > LENS_NAMED * sd) & (size > LENS_LEAST)).any(axis=1)
    return off


def _holds_elsewhere(found: Found, records: tuple[CameraRecord, ...], priors: Priors) -> bool:
    """Return whether the intrinsics found in each half of the recording lower the other's cost."""
    both = tuple(with_variances_of(found.seen, one) for one in halves(found, records))
    refined = [adjusted(one, found.rig.state, priors, annealing=(1.0,)) for one in both]
    others = zip(both, reversed(refined), strict=True)
    return sum(_gain_with(one, found, other) for one, other in others) > 0.0


def _gain_with(seen: Observations, found: Found, lenses_of: Adjusted) -> float:
    """Return what the intrinsics of another adjustment gain, all else fitted to `seen`."""
    given, changed = found.rig.state, found.rig.state.copy()
    changed.lens[:] = lenses_of.state.lens
    before, after = (
        adjusted(seen, state, found.priors, annealing=(1.0,)) for state in (given, changed)
    )
    return gained(seen, before, after)
