"""PCP3D: the share of correct body parts, as the literature counts it on Shelf and Campus."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.errors import InputError
from trecsim.lab.evaluation.pcp_joints import (
    GROUP_OF_PART,
    GROUPS,
    LIMB_JOINTS,
    N_PARTS,
    parts_correct,
)
from trecsim.lab.evaluation.person_tracks import mean_of_known

AVERAGED_ACTORS = 3  # the fourth of Shelf is left out of every published average
FOUND_M = 0.5  # gate: largest distance of a match, mean over the joints


@dataclass(frozen=True, slots=True)
class ActorPcp:
    """PCP and identity figures of one annotated person.

    Attributes
    ----------
    actor
        Number, from 1 as in the literature.
    frames
        Number of frames in which the person is annotated.
    correct, total
        Number of correct parts, and of all parts; ten per frame.
    group_correct, group_total
        The same for each of :data:`GROUPS`.
    found
        Frames with a track within half a metre, mean over the joints.
    switches
        Number of identity switches: another identity than at the last match.
    claims
        Tracks in those frames that are nearer to this person than to any other annotated one, and
        within half a metre.
    claimed
        Frames with at least one of these tracks.
    limb_joints, error_m
        Number of the 12 limb joints that are known in matched frames, and sum of their errors [m].
    """

    actor: int
    frames: int
    correct: int
    total: int
    group_correct: tuple[int, ...]
    group_total: tuple[int, ...]
    found: int
    switches: int
    claims: int
    claimed: int
    limb_joints: int
    error_m: float

    @property
    def pcp(self) -> float:
        """Share of correct parts [%]; NaN if never annotated."""
        return _percent(self.correct, self.total)

    @property
    def missed(self) -> int:
        """Frames without a track within half a metre."""
        return self.frames - self.found

    @property
    def precision(self) -> float:
        """Share of the tracks at this person that are not duplicates; NaN without any."""
        return self.claimed / self.claims if self.claims else float("nan")

    @property
    def mpjpe_m(self) -> float:
        """Mean error of the 12 limb joints where matched [m]; NaN without any."""
        return self.error_m / self.limb_joints if self.limb_joints else float("nan")

    def row(self) -> dict[str, float]:
        """Return the figures as a row of a table."""
        groups = zip(GROUPS, self.group_correct, self.group_total, strict=True)
        return {
            "actor": self.actor,
            "frames": self.frames,
            "correct": self.correct,
            "total": self.total,
            "pcp": self.pcp,
            **{group: _percent(correct, total) for group, correct, total in groups},
            "missed": self.missed,
            "switches": self.switches,
            "precision": self.precision,
            "mpjpe_mm": 1e3 * self.mpjpe_m,
        }


@dataclass(frozen=True, slots=True)
class Pcp:
    """PCP3D of a recording; actors in the order of the annotation."""

    actors: tuple[ActorPcp, ...]

    @property
    def average(self) -> float:
        """Mean PCP of the first three actors [%], equally weighted, as in the literature."""
        return _mean([actor.pcp for actor in self.actors[:AVERAGED_ACTORS]])

    @property
    def groups(self) -> dict[str, float]:
        """PCP per group of parts, mean over the first three actors [%]."""
        rows = [actor.row() for actor in self.actors[:AVERAGED_ACTORS]]
        return {group: _mean([row[group] for row in rows]) for group in GROUPS}

    @property
    def recall(self) -> float:
        """Share of the annotated person-frames with a track within half a metre."""
        frames = sum(actor.frames for actor in self.actors)
        return self.found / frames if frames else float("nan")

    @property
    def found(self) -> int:
        """Person-frames with a track within half a metre."""
        return sum(actor.found for actor in self.actors)

    @property
    def missed(self) -> int:
        """Person-frames without one."""
        return sum(actor.missed for actor in self.actors)

    @property
    def switches(self) -> int:
        """Number of identity switches, over all actors."""
        return sum(actor.switches for actor in self.actors)

    @property
    def mpjpe_m(self) -> float:
        """Mean error of the 12 limb joints over all matched person-frames [m]; NaN without any."""
        joints = sum(actor.limb_joints for actor in self.actors)
        return sum(actor.error_m for actor in self.actors) / joints if joints else float("nan")

    def summary(self) -> dict[str, float]:
        """Return the figures of all actors together."""
        return {
            "pcp": self.average,
            **{f"pcp_actor_{actor.actor}": actor.pcp for actor in self.actors},
            "recall_500mm": self.recall,
            "missed": self.missed,
            "switches": self.switches,
            "mpjpe_mm": 1e3 * self.mpjpe_m,
        }


def _percent(part: int, whole: int) -> float:
    return 100.0 * part / whole if whole else float("nan")


def _mean(values: Sequence[float]) -> float:
    known = [value for value in values if not np.isnan(value)]
    return sum(known) / len(known) if known else float("nan")


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """Tracks in one frame, with the joints that are annotated."""

    id: Int64[np.ndarray, " person"]
    joints_m: Float64[np.ndarray, "person 14 3"]


def count_pcp(
    frames: Sequence[Found],
    truth_m: Float64[np.ndarray, "actor frame 14 3"],
) -> Pcp:
    """Count correct parts.

    Parameters
    ----------
    frames
        The tracks, one entry per frame of the annotation.
    truth_m
        The annotation; a person with a joint of NaN is not annotated in that frame [m].

    Raises
    ------
    InputError
        The numbers of frames differ.

    Notes
    -----
    Each annotated person takes the nearest track, mean over the joints that are not NaN; two may
    take the same. Identities count where that track is within half a metre.
    """
    if len(frames) != truth_m.shape[1]:
        raise InputError(
            f"expected tracks in {truth_m.shape[1]} frames, as many as are annotated, "
            f"got {len(frames)}"
        )
    counts = [_Count() for _ in truth_m]
    there = np.isfinite(truth_m).all(axis=(2, 3))
    for frame, found in enumerate(frames):
        actors = np.flatnonzero(there[:, frame])
        bodies_m = truth_m[actors, frame]
        apart_m = _apart(bodies_m, found.joints_m)
        for row, column in enumerate(apart_m.argmin(axis=1).tolist() if len(found.id) else ()):
            counts[actors[row]].add(bodies_m[row], found, column, float(apart_m[row, column]))
        _claim([counts[actor] for actor in actors], apart_m)
    return Pcp(
        tuple(
            count.result(number + 1, int(there[number].sum()))
            for number, count in enumerate(counts)
        )
    )


def _apart(
    truth_m: Float64[np.ndarray, "actor 14 3"], found_m: Float64[np.ndarray, "found 14 3"]
) -> Float64[np.ndarray, "actor found"]:
    """Return the mean distance over the joints that both have; infinite without any."""
    distance_m = np.linalg.norm(truth_m[:, None] - found_m[None], axis=-1)
    return np.asarray(np.nan_to_num(mean_of_known(distance_m, axis=-1), nan=np.inf))


def _claim(counts: "Sequence[_Count]", apart_m: Float64[np.ndarray, "actor found"]) -> None:
    if not apart_m.size:
        return
    nearest = apart_m.argmin(axis=0)[apart_m.min(axis=0) < FOUND_M]
    for row, count in enumerate(counts):
        claims = int((nearest == row).sum())
        count.claims += claims
        count.claimed += claims > 0


@dataclass(slots=True)
class _Count:
    parts: Int64[np.ndarray, " group"] = field(
        default_factory=lambda: np.zeros(len(GROUPS), np.int64)
    )
    found: int = 0
    switches: int = 0
    claims: int = 0
    claimed: int = 0
    limb_joints: int = 0
    error_m: float = 0.0
    identity: int | None = None

    def add(
        self, truth_m: Float64[np.ndarray, "14 3"], found: Found, column: int, apart_m: float
    ) -> None:
        body_m = found.joints_m[column]
        right = parts_correct(body_m, truth_m)
        self.parts += np.bincount(GROUP_OF_PART[right], minlength=len(GROUPS))
        if not apart_m < FOUND_M:
            return
        self.found += 1
        error_m = np.linalg.norm(body_m - truth_m, axis=-1)[:LIMB_JOINTS]
        known = np.isfinite(error_m)
        self.limb_joints += int(known.sum())
        self.error_m += float(error_m[known].sum())
        identity = int(found.id[column])
        self.switches += self.identity not in (None, identity)
        self.identity = identity

    def result(self, actor: int, frames: int) -> ActorPcp:
        group_total = frames * np.bincount(GROUP_OF_PART)
        return ActorPcp(
            actor=actor,
            frames=frames,
            correct=int(self.parts.sum()),
            total=N_PARTS * frames,
            group_correct=tuple(self.parts.tolist()),
            group_total=tuple(group_total.tolist()),
            found=self.found,
            switches=self.switches,
            claims=self.claims,
            claimed=self.claimed,
            limb_joints=self.limb_joints,
            error_m=self.error_m,
        )
