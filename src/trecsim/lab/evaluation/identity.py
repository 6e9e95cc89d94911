"""Identity scores of the literature: IDF1, MOTA, HOTA."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.extras import needed
from trecsim.lab.evaluation.assignment import heaviest_pairs
from trecsim.lab.evaluation.moments import Moments
from trecsim.lab.evaluation.truth_matching import GATE_M, NOBODY, Nearness

REACH_M = 2 * GATE_M  # distance from which the similarity is 0
THRESHOLD = 0.5  # of similarity; the same as GATE_M of distance

_KEEP = 1000.0  # more than all similarities of a frame together
_FEW = 64  # pairs in a frame; larger frames are split into independent parts

Frame = tuple[list[int], list[int], list[list[float]]]


@dataclass(frozen=True, slots=True)
class Identity:
    """Identity scores; NaN without any person-frame.

    Attributes
    ----------
    switches
        Number of times a person's identity changed since the last match.
    idf1
        F1 of person-frames with the right identity, one identity per person (Ristani).
    mota
        1 minus the shares of missed people, false positives and switches (CLEAR MOT, Bernardin).
    mota_switches
        Switches as MOTA counts them: a pair is kept while it stays within the gate.
    hota, deta, assa
        Geometric mean of the accuracies of detection and association, over all thresholds
        (Luiten), and these two.
    """

    switches: int
    idf1: float
    mota: float
    mota_switches: int
    hota: float
    deta: float
    assa: float


class IdentityCount:
    """Passes distances to the library that computes identity scores.

    Similarity is ``max(0, 1 - d / 1 m)``, `d` the mean distance over the joints.

    Raises
    ------
    SetupError
        motrics is not installed.
    """

    def __init__(self, moments: Moments) -> None:
        self._motrics = needed("scores of identities need motrics", "evaluate", "motrics")
        self._id = moments.id
        self._clear = self._motrics.Accumulator(THRESHOLD)
        self._borne: dict[int, int] = {}
        self._frames: list[Frame] = []
        self._truly = 0

    def add(self, near: Nearness) -> None:
        """Add the next stretch of time."""
        similarity = np.nan_to_num(np.maximum(0.0, 1.0 - near.mean_m / REACH_M), nan=0.0)
        there = np.asarray(near.known.any(axis=2))
        for now, row, alike in zip(there, near.row, similarity, strict=True):
            found = self._id[row[row != NOBODY]]
            self._add(near.person[now], found, alike[now, : len(found)])

    def _add(
        self,
        true: Int64[np.ndarray, " truth"],
        found: Int64[np.ndarray, " person"],
        alike: Float64[np.ndarray, "truth person"],
    ) -> None:
        self._truly += len(true)
        self._frames.extend(_parts(true, found, alike))
        if alike.size:
            kept = found == np.array([[self._borne.get(person, -1)] for person in true.tolist()])
            pairs = clear_pairs(alike, kept)
            rows, columns = (list(part) for part in zip(*pairs, strict=True)) if pairs else ([], [])
            self._borne = dict(zip(true[rows].tolist(), found[columns].tolist(), strict=True))
            alone = np.zeros(alike.shape)
            alone[rows, columns] = alike[rows, columns]
            alike = alone
        self._clear.update_from_similarity(true.tolist(), found.tolist(), alike.tolist())

    def result(self, switches: int) -> Identity:
        """Return the scores; `switches` are those of `ground_truth.compare`."""
        clear = self._clear.compute().clear
        nan = float("nan")
        if not self._truly:
            return Identity(switches, nan, nan, clear.num_switches, nan, nan, nan)
        true, found, alike = (list(part) for part in zip(*self._frames, strict=True))
        identity = self._motrics.compute_identity_from_similarity(true, found, alike, THRESHOLD)
        hota = self._motrics.compute_hota_from_similarity(true, found, alike)
        return Identity(
            switches=switches,
            idf1=float(identity.idf1),
            mota=float(clear.mota),
            mota_switches=int(clear.num_switches),
            hota=float(hota.hota),
            deta=float(hota.deta),
            assa=float(hota.assa),
        )


def clear_pairs(
    alike: Float64[np.ndarray, "truth person"], kept: Bool[np.ndarray, "truth person"]
) -> tuple[tuple[int, int], ...]:
    """Return the pairs of a frame by the definition of CLEAR MOT.

    Pairs of the previous frame that are still within the gate come first, then the rest with the
    largest sum of similarities. The library would prefer more pairs to kept ones, so it is given
    only these.
    """
    allowed = alike >= THRESHOLD
    if (allowed.sum(axis=0) <= 1).all() and (allowed.sum(axis=1) <= 1).all():
        return tuple((int(row), int(column)) for row, column in np.argwhere(allowed))
    return heaviest_pairs(np.where(allowed, alike + _KEEP * kept, 0.0))


def _parts(
    true: Int64[np.ndarray, " truth"],
    found: Int64[np.ndarray, " person"],
    alike: Float64[np.ndarray, "truth person"],
) -> Iterator[Frame]:
    """Yield a frame, large ones in independent parts; IDF1 and HOTA use pairs and counts only.

    In a crowd most people have exactly one candidate; without the zeros between them an hour of
    fifty people fits into memory.
    """
    if alike.size > _FEW:
        near = alike > 0
        lone = near & (near.sum(axis=1, keepdims=True) == 1) & (near.sum(axis=0) == 1)
        for row, column in np.argwhere(lone):
            yield [int(true[row])], [int(found[column])], [[float(alike[row, column])]]
        rows, columns = ~lone.any(axis=1), ~lone.any(axis=0)
        true, found, alike = true[rows], found[columns], alike[np.ix_(rows, columns)]
    yield true.tolist(), found.tolist(), alike.tolist()
