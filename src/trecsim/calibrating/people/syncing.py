"""Clocks of recordings, from the people in them: offset and drift of each camera."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from trecsim.calibrating.people.adjusting import Adjusted, adjusted
from trecsim.calibrating.people.camera_records import CameraRecord, records
from trecsim.calibrating.people.chains import chains
from trecsim.calibrating.people.lags import lag_relations, lags
from trecsim.calibrating.people.observations import observations
from trecsim.calibrating.people.pairs import Relation
from trecsim.calibrating.people.pose_uncertainty import clock_sd
from trecsim.calibrating.people.priors import WITHOUT_LENS, Priors
from trecsim.calibrating.people.refitting import given
from trecsim.calibrating.people.shortcomings import HOW, refuse
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tracklets import tracklets
from trecsim.calibrating.people.tuning import DRIFT_PPM, STAY_SHIFT_M, STAY_TURN_DEG
from trecsim.calibrating.people.world import by_clock_of
from trecsim.calibrating.result import CalibrationResult, CameraQuality, Finding, judge
from trecsim.errors import CalibrationError
from trecsim.geometry import Rig
from trecsim.values import Poses2D

GOOD_S, USABLE_S = 0.005, 0.02
CLEAR = 1.6  # the best lag must have so many times the evidence of the next
ROUNDS = 2


@dataclass(frozen=True, slots=True, eq=False)
class Synced:
    """Clocks that were found.

    Attributes
    ----------
    rig
        The given cameras with their clocks.
    result
        How sure they are.
    offset_sd_s
        Of each camera [s]; NaN where it was not found.
    """

    rig: Rig
    result: CalibrationResult
    offset_sd_s: np.ndarray

    def mended(self, image: Poses2D, before: Rig) -> Poses2D:
        """Return an image with the stamp that, read with the rig as it was, gives its true time."""
        time_s = self.rig[image.camera].time_s(image.t_s)
        return replace(image, t_s=before[image.camera].stamp_s(time_s))


def sync_clocks(poses: Iterable[Poses2D], rig: Rig, *, longest_s: float) -> Synced:
    """Return offset and drift of each camera's clock, by the people whom several cameras see.

    Parameters
    ----------
    poses
        2D poses of a recording, in any order.
    rig
        The cameras; offsets in it are where the search begins.
    longest_s
        Clocks differ by so much at most [s].

    Raises
    ------
    CalibrationError
        No two cameras see the same people walk; the message says how to record.
    """
    recorded = records(poses, rig)
    refuse(recorded)
    tracks = [one for c, record in enumerate(recorded) for one in tracklets(record, c)]
    state = given(rig)
    relations = lag_relations(recorded, tracks, state, longest_s)
    lag, group = lags(relations, len(rig))
    largest = int(np.argmax(np.bincount(group, minlength=len(rig))))
    state.found[:] = group == largest
    if state.found.sum() < 2:
        raise CalibrationError(
            f"no two cameras see the same people walk within {longest_s:g} s of each other: is the "
            f"rig right, and are these its cameras? {HOW}"
        )
    state.clock[:, 0] += lag
    state = state.referred(np.array([_middle_s(record) for record in recorded]))
    chain = chains(tracks, recorded, state, by_rays=True, looser=2.0)
    root = int(np.flatnonzero(state.found)[0])
    sd = np.tile([np.radians(STAY_TURN_DEG), STAY_SHIFT_M], (len(rig), 1))
    made = None
    for _ in range(ROUNDS):
        seen = observations(tracks, recorded, chain, state)
        if not seen.count:
            raise CalibrationError(f"no two cameras see the same people where the rig says; {HOW}")
        priors = Priors(root, (), state.found, pose=given(rig).T, pose_sd=sd)
        made = adjusted(seen, state, priors, annealing=(2.0, 1.0))
        state = replace(made.state, T=state.T)
    assert made is not None
    return _told(rig, recorded, made, root, relations)


def _middle_s(record: CameraRecord) -> float:
    return 0.5 * float(record.t_s[0] + record.t_s[-1]) if len(record.t_s) else 0.0


def _told(
    rig: Rig, recorded: tuple[CameraRecord, ...], made: Adjusted, root: int,
    relations: list[Relation],
) -> Synced:  # fmt: skip
    found = made.state.found
    stamps = [t for record in recorded if len(record.t_s) for t in record.t_s[[0, -1]]]
    ref_s = 0.5 * float(min(stamps) + max(stamps))
    offset_sd, drift_sd = clock_sd(made, WITHOUT_LENS)
    seconds = np.array([np.ptp(r.t_s) if len(r.t_s) else 0.0 for r in recorded])
    state = by_clock_of(_steadied(made.state, drift_sd), root, ref_s)
    cameras, qualities = [], []
    for c, camera in enumerate(rig):
        if not found[c]:
            cameras.append(camera)
            qualities.append(CameraQuality(camera.name))
            continue
        offset_s, drift = float(state.clock[c, 0]), float(1e6 * state.clock[c, 1])
        cameras.append(
            replace(camera, time_offset_s=offset_s, time_drift_ppm=drift, time_ref_s=ref_s)
        )
        qualities.append(CameraQuality(camera.name, time_offset_s=offset_s, time_drift_ppm=drift))
    sd = np.where(found, offset_sd, np.nan)
    sd[root] = 0.0
    verdict, reasons = judge(list(_findings(rig, found, sd, relations, seconds)))
    return Synced(
        Rig(tuple(cameras)), CalibrationResult(tuple(qualities), verdict, reasons, ref_s), sd
    )


def _steadied(state: RigState, sd: np.ndarray) -> RigState:
    """Return the state with drifts drawn to nothing as far as the recording does not show them."""
    steady, usual = state.copy(), 1e-6 * DRIFT_PPM
    for c in np.flatnonzero(state.found):
        drift = state.clock[c, 1]
        spread = max(usual, abs(drift)) if abs(drift) > 4.0 * max(sd[c], usual) else usual
        steady.clock[c, 1] = drift * spread**2 / (spread**2 + sd[c] ** 2)
    return steady


def _findings(
    rig: Rig, found: np.ndarray, sd: np.ndarray, relations: list[Relation], seconds: np.ndarray
) -> Iterator[Finding]:
    lost = [name for name, there in zip(rig.names, found, strict=True) if not there]
    if lost:
        yield Finding(
            "usable",
            f"{', '.join(map(repr, lost))} keeps its clock: it sees nobody walk whom "
            "the others see",
        )
    worst = float(np.nanmax(sd))
    verdict = "good" if worst < GOOD_S else "usable" if worst < USABLE_S else "wrong"
    yield Finding(
        verdict,  # type: ignore[arg-type]  # one of the three
        f"offsets are known to {1e3 * worst:.1f} ms (one standard deviation)",
    )
    for c, name in enumerate(rig.names):
        own = [one for one in relations if c in (one.a, one.b) and found[one.a] and found[one.b]]
        best = max((one.score / max(one.rival, 1e-9) for one in own), default=np.inf)
        if found[c] and best < CLEAR:
            yield Finding(
                "wrong" if best < 1.2 else "usable",
                f"the clock of {name!r} is ambiguous: another offset explains the people's ways "
                "nearly as well; let people walk curves, stop and turn",
            )
    if float(seconds[found].min()) < 30.0:
        yield Finding("good", "drifts are hardly known from less than 30 s, and are kept small")
