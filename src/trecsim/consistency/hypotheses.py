"""What might be wrong with cameras that do not agree: each is tried, and the best is told."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations, permutations

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.consistency.camera_pairs import Eye, agreement
from trecsim.consistency.thresholds import Thresholds
from trecsim.geometry import Rig
from trecsim.geometry.view import rays

SCALES = (2.0, 1.5, 3.0, 4.0, 0.5, 2 / 3, 1 / 3, 0.25)
# Rigs are often symmetrical, and several causes explain as much: then the likeliest is told, which
# is tried first. A later one must explain so many times more.
BETTER = 1.1
MOST_PERMUTED = 4  # cameras; of more, only two are exchanged at a time

Torsos = Float64[np.ndarray, "moment cam detection 4 2"]


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """What would have to be done with key points for the cameras to agree.

    Attributes
    ----------
    cause
        "scaled", "mirrored" or "exchanged".
    source
        For each camera concerned, the camera whose key points it gets.
    factor
        By how much key points are multiplied.
    """

    cause: str
    source: dict[int, int]
    factor: float = 1.0


@dataclass(slots=True)
class Trial:
    """Cameras and what they saw, so that hypotheses can be tried on them.

    Attributes
    ----------
    rig, torso_px
        The cameras and the torsos in their raw images.
    cameras
        Indices of those that take part.
    agreed, tried
        Of each two of them, as given: in how many cases they agree, and in how many they might.
    """

    rig: Rig
    torso_px: Torsos
    cameras: tuple[int, ...]
    agreed: Int64[np.ndarray, "cam cam"] = field(init=False)
    tried: Int64[np.ndarray, "cam cam"] = field(init=False)
    _eyes: dict[int, Eye] = field(init=False)

    def __post_init__(self) -> None:
        n = len(self.rig)
        self.agreed, self.tried = np.zeros((n, n), np.int64), np.zeros((n, n), np.int64)
        self._eyes = {c: self._eye(c, self.torso_px[:, c]) for c in self.cameras}
        for a, b in combinations(self.cameras, 2):
            found, might = agreement(self._eyes[a], self._eyes[b])
            self.agreed[a, b] = self.agreed[b, a] = found
            self.tried[a, b] = self.tried[b, a] = might

    def _eye(self, cam: int, torso_px: Float64[np.ndarray, "moment detection 4 2"]) -> Eye:
        camera = self.rig.cameras[cam]
        return Eye(camera.position_m, rays(camera, torso_px))

    def share(self, cameras: Sequence[int]) -> float:
        """Return in which share of the cases cameras agree with each other, as given."""
        among = np.ix_(cameras, cameras)
        return float(self.agreed[among].sum() / max(1, self.tried[among].sum()))

    def best_partner(self, cam: int, fewest: int) -> float:
        """Return the share of cases in which a camera agrees with the one it agrees best with."""
        good = self.tried[cam] >= fewest
        return float((self.agreed[cam][good] / self.tried[cam][good]).max()) if good.any() else 0.0

    def core(self, limit: Thresholds) -> list[int]:
        """Return the cameras that agree with each other; none, if no two do."""
        left = [c for c in self.cameras if self.tried[c].any()]
        while len(left) > 1:
            agreed = self.agreed[np.ix_(left, left)].sum(axis=1)
            tried = self.tried[np.ix_(left, left)].sum(axis=1)
            share = np.where(tried > 0, agreed / np.maximum(tried, 1), 0.0)
            if share.min() >= limit.agree_share:
                return left
            left.pop(int(share.argmin()))
        return []

    def gain(self, one: Hypothesis, partners: Sequence[int]) -> tuple[int, float, float]:
        """Return what a hypothesis would bring for the pairs that it concerns.

        Returns
        -------
        How many more cases agree, and the share of cases that agree as given and then.
        """
        changed = {c: self._eye(c, self._changed(one, c)) for c in one.source}
        pairs = {tuple(sorted((a, b))) for a in changed for b in (*partners, *changed) if a != b}
        before = after = might = tried = 0
        for a, b in pairs:
            before += int(self.agreed[a, b])
            tried += int(self.tried[a, b])
            found, cases = agreement(changed.get(a, self._eyes[a]), changed.get(b, self._eyes[b]))
            after, might = after + found, might + cases
        return after - before, before / max(tried, 1), after / max(might, 1)

    def _changed(self, one: Hypothesis, cam: int) -> Float64[np.ndarray, "moment detection 4 2"]:
        torso_px = self.torso_px[:, one.source[cam]] * one.factor
        if one.cause == "mirrored":
            torso_px[..., 0] = self.rig.cameras[cam].size_px[0] - 1 - torso_px[..., 0]
        return torso_px


def explained(trial: Trial, core: Sequence[int], limit: Thresholds) -> Hypothesis | None:
    """Return the hypothesis under which most of what does not agree does, if one is clear.

    Parameters
    ----------
    trial
        The cameras and what they saw.
    core
        Those that agree with each other.
    limit
        What is clear.
    """
    suspects = [c for c in trial.cameras if c not in core and trial.tried[c].any()]
    if not suspects:
        return None
    partners, best, most = core or trial.cameras, None, 0
    right = limit.right_share if len(trial.cameras) > 2 else limit.right_share_of_two
    for one in _hypotheses(trial.cameras, suspects):
        more, before, after = trial.gain(one, partners)
        if more > BETTER * most and after >= right and after - before >= limit.gain_share:
            best, most = one, more
    return best


def as_good(
    trial: Trial, core: Sequence[int], found: Hypothesis, limit: Thresholds
) -> Hypothesis | None:
    """Return the exchange of the other two cameras, if it explains as much as the one `found`.

    In a symmetric room, two cameras at opposite corners that are exchanged see the room turned
    round. They agree with each other, and the other two do: whose names are right is not to be
    seen.
    """
    if found.cause != "exchanged" or len(found.source) != 2 or len(core) != 2:
        return None
    first, second = core
    other = Hypothesis("exchanged", {first: second, second: first})
    _, _, after = trial.gain(other, tuple(found.source))
    return other if after >= limit.right_share else None


def _hypotheses(cameras: Sequence[int], suspects: Sequence[int]) -> Iterator[Hypothesis]:
    everywhere = {c: c for c in cameras}
    yield from (Hypothesis("scaled", everywhere, factor) for factor in SCALES)
    if len(suspects) == 1:
        alone = suspects[0]
        yield from (Hypothesis("exchanged", {alone: c, c: alone}) for c in cameras if c != alone)
    elif len(suspects) <= MOST_PERMUTED:
        for order in permutations(suspects):
            source = {a: b for a, b in zip(suspects, order, strict=True) if a != b}
            if source:
                yield Hypothesis("exchanged", source)
    else:
        for a, b in combinations(suspects, 2):
            yield Hypothesis("exchanged", {a: b, b: a})
    for c in suspects:
        yield from (Hypothesis("scaled", {c: c}, factor) for factor in SCALES)
        yield Hypothesis("mirrored", {c: c})
    yield Hypothesis("mirrored", everywhere)
