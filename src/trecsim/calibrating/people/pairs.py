"""How the floors and clocks of two cameras lie to each other."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.people.floor_tracks import FloorTracks
from trecsim.calibrating.people.kernels.matching_tracks import agreement, scan
from trecsim.calibrating.people.tuning import (
    LEAST_MATCHED_S,
    LONGEST_OFFSET_S,
    MOST_HYPOTHESES,
    SHORTEST_OVERLAP_S,
    TICK_S,
)

ROUNDS = 4


@dataclass(frozen=True, slots=True, eq=False)
class Relation:
    """The motion of camera b's floor, and the lag of its clock, that bring it to camera a's.

    Attributes
    ----------
    a, b
        Numbers of the cameras.
    score
        Time over which tracks agree, each moment by how well [s].
    rival
        Score of the best relation that is clearly another one [s].
    lag_s
        What is added to stamps of b to have those of a [s].
    angle_rad, shift_m
        The motion of the floor.
    """

    a: int
    b: int
    score: float
    rival: float
    lag_s: float
    angle_rad: float
    shift_m: Float64[np.ndarray, " 2"]


def relate(
    a: int,
    b: int,
    tracks_a: FloorTracks,
    tracks_b: FloorTracks,
    *,
    turns: bool = True,
    longest_s: float = LONGEST_OFFSET_S,
) -> Relation | None:
    """Return how two cameras are related; None if no motion brings their tracks together."""
    of_a = (tracks_a.first, tracks_a.tick, tracks_a.xy_m)
    of_b = (tracks_b.first, tracks_b.tick, tracks_b.xy_m)
    out = np.zeros((MOST_HYPOTHESES, 5))
    lag, fewest = int(longest_s / TICK_S), int(SHORTEST_OVERLAP_S / TICK_S)
    made = scan(*of_a, *of_b, lag, fewest, turns, out)
    tested = [tested_on_all(of_a, of_b, motion, turns=turns) for motion in out[:made]]
    if not tested:
        return None
    tested.sort(key=lambda motion: -motion[0])
    best = tested[0]
    if best[0] < LEAST_MATCHED_S:
        return None
    rival = next((motion[0] for motion in tested[1:] if _is_other(motion, best)), 0.0)
    return Relation(
        a, b, float(best[0]), float(rival), float(best[1] * TICK_S), float(best[2]), best[3:5]
    )


Tracks = tuple[Int64[np.ndarray, "..."], Int64[np.ndarray, "..."], Float64[np.ndarray, "..."]]


def _is_other(motion: Float64[np.ndarray, " 5"], best: Float64[np.ndarray, " 5"]) -> bool:
    turn = abs((motion[2] - best[2] + np.pi) % (2 * np.pi) - np.pi)
    return bool(abs(motion[1] - best[1]) > 4 or turn > 0.35)


def tested_on_all(
    of_a: Tracks, of_b: Tracks, motion: Float64[np.ndarray, " 5"], *, turns: bool
) -> Float64[np.ndarray, " 5"]:
    """Return a motion refined on all tracks that agree, scored by the time they agree [s]."""
    best, motion = np.zeros(5), motion.copy()
    for _ in range(ROUNDS):
        couples, score = couples_of(of_a, of_b, motion)
        if score <= best[0]:
            break
        best = np.concatenate(([score], motion[1:]))
        trials = [best]
        for lag in (motion[1] - 1, motion[1], motion[1] + 1):
            found = _refitted(of_a, of_b, couples, lag, motion, turns=turns)
            if found is not None:
                trials.append(np.concatenate(([couples_of(of_a, of_b, found)[1]], found[1:])))
        motion = max(trials, key=lambda trial: trial[0])
    return np.concatenate(([best[0] * TICK_S], best[1:]))


def couples_of(
    of_a: Tracks, of_b: Tracks, motion: Float64[np.ndarray, " 5"]
) -> tuple[list[tuple[int, int]], float]:
    """Return the tracks that are the same person, and in how many ticks they agree."""
    n_a, n_b = len(of_a[1]), len(of_b[1])
    matched, common = np.zeros((n_a, n_b)), np.zeros((n_a, n_b))
    agreement(*of_a, *of_b, motion, matched, common)
    a, b = np.nonzero(matched > 0.3 * np.maximum(common, 5))
    order = np.argsort(-matched[a, b])
    span_a = np.stack((of_a[1], of_a[1] + np.diff(of_a[0])))
    span_b = np.stack((of_b[1], of_b[1] + np.diff(of_b[0]))) + motion[1]
    chosen: list[tuple[int, int, float, float]] = []
    score = 0.0
    for k in order:
        i, j = int(a[k]), int(b[k])
        low, high = max(span_a[0, i], span_b[0, j]), min(span_a[1, i], span_b[1, j])
        if any((i == p or j == q) and low < e - 2 and high > s + 2 for p, q, s, e in chosen):
            continue
        chosen.append((i, j, low, high))
        score += matched[i, j]
    return [(i, j) for i, j, _, _ in chosen], float(score)


def _refitted(
    of_a: Tracks,
    of_b: Tracks,
    couples: list[tuple[int, int]],
    lag: float,
    motion: Float64[np.ndarray, " 5"],
    *,
    turns: bool,
) -> Float64[np.ndarray, " 5"] | None:
    """Return the least-squares motion of the couples at a lag."""
    p, q = [], []
    for a, b in couples:
        n_a, n_b = of_a[0][a + 1] - of_a[0][a], of_b[0][b + 1] - of_b[0][b]
        shift = int(of_a[1][a] - of_b[1][b] - round(lag))
        start, stop = max(0, -shift), min(n_a, n_b - shift)
        if stop > start:
            p.append(of_a[2][of_a[0][a] + start : of_a[0][a] + stop])
            q.append(of_b[2][of_b[0][b] + start + shift : of_b[0][b] + stop + shift])
    if not p:
        return None
    if not turns:
        return np.array([0.0, lag, 0.0, 0.0, 0.0])
    z, w = (np.concatenate(part) @ np.array([1.0, 1.0j]) for part in (p, q))
    off = np.abs(z - np.exp(1j * motion[2]) * w - (motion[3] + 1j * motion[4]))
    weight = 1.0 / (1.0 + (off / 0.3) ** 2)
    z0, w0 = (weight * z).sum() / weight.sum(), (weight * w).sum() / weight.sum()
    turn = (weight * np.conj(w - w0) * (z - z0)).sum()
    if abs(turn) == 0.0:
        return None
    turn /= abs(turn)
    shift_m = z0 - turn * w0
    return np.array([0.0, lag, np.angle(turn), shift_m.real, shift_m.imag])
