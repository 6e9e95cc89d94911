"""Which cameras do not fit, and why, by what the last moments say of them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from statistics import median

import numpy as np
from jaxtyping import Float64

from trecsim.consistency import told
from trecsim.consistency.camera_evidence import Evidence, off_without
from trecsim.consistency.hypotheses import Trial, as_good, explained
from trecsim.consistency.sights import Moment, gather
from trecsim.consistency.spans import Span
from trecsim.consistency.thresholds import Thresholds
from trecsim.consistency.tracked import Witnessed, compare
from trecsim.consistency.turns import Turn, voted
from trecsim.consistency.verdict import Verdict
from trecsim.geometry import Rig


@dataclass(frozen=True, slots=True, eq=False)
class Records:
    """All that is known of a run.

    Attributes
    ----------
    rig
        The cameras.
    limit
        What is clear.
    history
        What each batch said, in order.
    recent
        The last moments.
    spans
        When each camera delivered.
    ended
        Whether it is over.
    """

    rig: Rig
    limit: Thresholds
    history: Sequence[Evidence]
    recent: Sequence[Moment]
    spans: Sequence[Span]
    ended: bool

    @property
    def last(self) -> Sequence[Moment]:
        """The moments of the last batches."""
        return self.recent[-self.limit.window * self.limit.batch :]


def suspicious(history: Sequence[Evidence], limit: Thresholds) -> list[int]:
    """Return the cameras of which too little agrees with the others in their last batches."""
    return [c for c in range(len(history[-1].found)) if _is_suspicious(history, c, limit)]


def _is_suspicious(history: Sequence[Evidence], c: int, limit: Thresholds) -> bool:
    last = _last_of(history, c, limit)
    detections, explained_, found, missed, empty = (
        sum(int(getattr(one, name)[c]) for one in last)
        for name in ("detections", "explained", "found", "missed", "empty")
    )
    if detections >= limit.fewest and explained_ < limit.explained_share * detections:
        return True
    if found + empty >= limit.fewest and empty > limit.empty_share * (found + empty):
        return True
    return found + missed >= limit.fewest and (
        missed > limit.missed_share * (found + missed)
        or median(one.turn[c].before_m for one in last) > limit.off_m
        or median(one.turn[c].shift_rad for one in last) > limit.turned_rad
    )


def _last_of(history: Sequence[Evidence], c: int, limit: Thresholds) -> list[Evidence]:
    """Return the last batches in which a camera saw somebody."""
    seeing = (one for one in reversed(history) if one.detections[c])
    return list(islice(seeing, limit.window))


def judged(records: Records, suspects: Sequence[int], cameras: Sequence[int]) -> Verdict | None:
    """Return what is wrong with cameras, if that is clear.

    Parameters
    ----------
    records
        All that is known of the run.
    suspects
        Cameras that do not agree with people whom others see.
    cameras
        All cameras that are not known to be wrong.
    """
    rig, limit = records.rig, records.limit
    if not suspects:
        return _moved(records, cameras)
    stride = max(1, len(cameras) * (len(cameras) - 1) // 2 // limit.pairs_at_once)
    torso_px = gather(records.recent[::stride], len(rig)).torso_px[:, :, : limit.most_tried]
    trial = Trial(rig, torso_px, tuple(cameras))
    core = trial.core(limit)
    found = explained(trial, core, limit)
    if found is not None:
        other = as_good(trial, core, found, limit)
        return Verdict(*told.hypothesis(found, rig, other), tuple(found.source))
    return (
        _turned(records, suspects)
        or _moved(records, cameras)
        or _unexplained(records, suspects, trial, core)
    )


def _turned(records: Records, suspects: Sequence[int]) -> Verdict | None:
    """Return the camera that a turn explains, if one is clear."""
    limit, rig = records.limit, records.rig
    seen = compare(gather(records.last, len(rig)), rig, limit)
    found = {c: turn for c in suspects if (turn := _turn(seen, c, records)) is not None}
    c = _alone(records, {c: (turn.before_m, turn.after_m) for c, turn in found.items()})
    if c is None or found[c].shift_rad < limit.turned_rad:
        return None
    since_s = _since(records.history, c, limit)
    return Verdict(f"turned {c}", told.turned(rig.names[c], found[c], since_s), (c,), clock=True)


def _turn(seen: Witnessed, c: int, records: Records) -> Turn | None:
    """Return the turn that explains nearly all that a camera sees, all the time."""
    limit, R = records.limit, records.rig.cameras[c].T_cam_world[:3, :3]
    ray, place_m = seen.all_rays[:, c] @ R.T, seen.from_camera_m[:, c] @ R.T
    turn, share = voted(ray, place_m)
    if turn.count < limit.fewest or share < limit.voted_share:
        return None
    if turn.after_m > 0.5 * turn.before_m:
        return None
    moments = np.flatnonzero(np.isfinite(ray[..., 0]).any(axis=(1, 2)))
    halves = [voted(ray[some], place_m[some])[0] for some in np.array_split(moments, 2)]
    drift_rad = float(_length(halves[0].offset_rad - halves[1].offset_rad))
    return turn if drift_rad <= limit.steady_share * turn.shift_rad else None


def _alone(records: Records, off_m: Mapping[int, tuple[float, float]]) -> int | None:
    """Return the one camera that is off, as the others agree when it is left out.

    Parameters
    ----------
    records
        All that is known of the run.
    off_m
        Of each camera that may be: how far it is off without and with its best turn [m].
    """
    if not off_m:
        return None
    limit = records.limit
    left_m = {c: off_without(records.last, c, records.rig, limit) for c in off_m}
    told_m = {c: value for c, value in left_m.items() if np.isfinite(value)}
    if told_m:
        c = min(told_m, key=lambda one: told_m[one])
        return c if told_m[c] <= limit.clean_share * off_m[c][0] else None
    # Of three cameras none can be left out. The one that is off is explained best by a turn.
    rest = sorted((after / max(before, 1e-9), c) for c, (before, after) in off_m.items())
    alone = len(rest) == 1 or rest[0][0] <= limit.clean_share * rest[1][0]
    return rest[0][1] if alone else None


def _since(history: Sequence[Evidence], c: int, limit: Thresholds) -> float | None:
    """Return from when on a camera has been off; None if it was from the beginning."""
    since_s, good = None, 0
    for one in history:
        cases, turn = one.found[c] + one.missed[c], one.turn[c]
        if cases < limit.fewest_in_batch:
            continue
        if (
            one.missed[c] <= limit.missed_share * cases
            and turn.before_m <= limit.good_m
            and turn.shift_rad <= limit.good_rad
        ):
            since_s, good = None, good + 1
        elif since_s is None:
            since_s = one.from_s
    return since_s if good > 1 else None


def _unexplained(
    records: Records, suspects: Sequence[int], trial: Trial, core: Sequence[int]
) -> Verdict | None:
    """Return what is to be said of cameras that do not agree, for no reason that was found."""
    limit, names = records.limit, records.rig.names
    if not records.ended and len(records.history) < limit.wait:
        return None
    tried = [c for c in trial.cameras if trial.tried[c].any()]
    if not core:
        total = int(trial.tried[np.ix_(tried, tried)].sum()) // 2
        if total >= limit.fewest_pairs and trial.share(tried) < limit.disagree_share:
            hint = next(filter(None, (told.clock_hint(c, records.spans) for c in tried)), "")
            text = told.wrong_rig(names, tried, trial.share(tried), hint)
            return Verdict("nobody agrees", text, tuple(tried), sure=False)
        return None
    share = np.zeros(len(names))
    for c in suspects:
        last = _last_of(records.history, c, limit)
        found, missed = (sum(int(getattr(one, k)[c]) for one in last) for k in ("found", "missed"))
        share[c] = missed / max(found + missed, limit.fewest_pairs)
    for one in (one for one in tried if one not in core):
        cases = int(trial.tried[one, list(core)].sum())
        apart = 1.0 - float(trial.agreed[one, list(core)].sum() / max(1, cases))
        if cases >= limit.fewest_pairs and apart > limit.disagree_share:
            share[one] = max(share[one], apart)
    c = max(suspects, key=lambda one: float(share[one]))
    if share[c] <= limit.odd_missed_share:
        return None
    since_s = _since(records.history, c, limit)
    waits = since_s is not None and records.history[-limit.wait :][0].from_s < since_s
    if waits and not records.ended:
        return None  # it may become clear how far it was moved
    hint = told.clock_hint(c, records.spans)
    text = told.odd(names[c], float(share[c]), since_s, hint)
    return Verdict(f"odd {c}", text, (c,), sure=False, clock=not hint)


def _moved(records: Records, cameras: Sequence[int]) -> Verdict | None:
    """Return the camera that was moved while it was recording, if that is clear."""
    limit, names = records.limit, records.rig.names
    steps = dict(_steps(records.history, cameras, limit))
    last = records.history[-1]
    c = _alone(records, {c: (last.turn[c].before_m, last.turn[c].after_m) for c in steps})
    if c is None:
        return None
    size_rad, since_s, off_m = steps[c]
    return Verdict(f"moved {c}", told.moved(names[c], size_rad, off_m, since_s), (c,), clock=True)


def _steps(
    history: Sequence[Evidence], cameras: Sequence[int], limit: Thresholds
) -> Iterator[tuple[int, tuple[float, float, float]]]:
    """Yield cameras whose offset has changed: by how much, since when, residual now [m]."""
    for c in cameras:
        known = [one for one in history if one.turn[c].count >= limit.fewest_in_batch]
        if len(known) < 4:
            continue
        offset = np.array([one.turn[c].offset_rad for one in known])
        base = np.median(offset[:-2], axis=0)
        away = _length(offset - base)
        noise_rad = max(float(np.median(away[:-2])), limit.steady_rad)
        least_rad = max(limit.moved_rad, limit.moved_noises * noise_rad)
        turns = [one.turn[c] for one in known[-2:]]
        off_m = min(turn.before_m for turn in turns)
        if turns[-1].after_m > 0.5 * turns[-1].before_m:
            continue
        if away[-2:].min() >= least_rad and off_m >= limit.moved_m:
            first = len(away) - 2
            while first > 0 and away[first - 1] >= 0.5 * least_rad:
                first -= 1
            yield c, (float(_length(offset[-2:].mean(axis=0) - base)), known[first].from_s, off_m)


def _length(vectors: Float64[np.ndarray, "*batch n"]) -> Float64[np.ndarray, "*batch"]:
    return np.asarray(np.sqrt((vectors**2).sum(axis=-1)))
