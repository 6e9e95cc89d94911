"""Limb lengths: bones have constant length, so their variation measures errors of the tracks.

The fourteen lines are those of the thesis (section 3.7.2, figure 21, table 1).
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Float64

from trecsim.lab.evaluation.person_tracks import PersonTrack, mean_of_known
from trecsim.skeleton import COCO17
from trecsim.store.truth import Truth

_LINES = {
    "nose - right shoulder": ("nose", "right_shoulder"),
    "nose - left shoulder": ("nose", "left_shoulder"),
    "shoulder width": ("left_shoulder", "right_shoulder"),
    "right upper arm": ("right_shoulder", "right_elbow"),
    "left upper arm": ("left_shoulder", "left_elbow"),
    "right forearm": ("right_elbow", "right_wrist"),
    "left forearm": ("left_elbow", "left_wrist"),
    "right trunk": ("right_shoulder", "right_hip"),
    "left trunk": ("left_shoulder", "left_hip"),
    "pelvis width": ("left_hip", "right_hip"),
    "right thigh": ("right_hip", "right_knee"),
    "left thigh": ("left_hip", "left_knee"),
    "right shin": ("right_knee", "right_ankle"),
    "left shin": ("left_knee", "left_ankle"),
}
LIMBS = tuple(_LINES)
"""Their names; `limb_named` finds them by other common names too."""

_SYNONYMS = {
    "shoulder width": ("shoulder line", "shoulders", "biacromial width"),
    "upper arm": ("brachium", "humerus"),
    "forearm": ("antebrachium", "lower arm", "radius", "ulna"),
    "trunk": ("flank", "torso", "trunk side", "shoulder to hip"),
    "pelvis width": ("waist", "pelvis", "hip width", "hips"),
    "thigh": ("upper leg", "femur"),
    "shin": ("lower leg", "shank", "calf", "tibia"),
}

_ENDS = np.array([[COCO17.index(joint) for joint in ends] for ends in _LINES.values()])
_NEAR_M = 0.5  # largest distance of a track from its person, mean over the joints
_MOST_MOMENTS = 200  # frames compared to identify the person of a track

Given = Mapping[int, Float64[np.ndarray, "14"]]
"""True lengths by identity, in the order of :data:`LIMBS`, NaN where not known [m]."""


def limb_named(name: str) -> str | None:
    """Return which of :data:`LIMBS` a name means, or None.

    Case, hyphens and underscores do not matter. Anatomical names and those of the thesis are
    known, as are the sides l and r.

    Examples
    --------
    >>> limb_named("Left humerus"), limb_named("waist"), limb_named("r_tibia"), limb_named("tail")
    ('left upper arm', 'pelvis width', 'right shin', None)
    """
    words = name.lower().replace("_", " ").replace("-", " ").split()
    sides = {"l": "left", "r": "right"}
    wanted = " ".join(sides.get(word, word) for word in words)
    for limb in LIMBS:
        side, _, part = (
            limb.partition(" ") if limb.startswith(("left ", "right ")) else ("", "", limb)
        )
        known = (part, *_SYNONYMS.get(part, ()))
        if wanted in (f"{side} {other}".strip().replace(" - ", " ") for other in known):
            return limb
    return None


def limb_lengths(xyz_m: Float[np.ndarray, "*batch 17 3"]) -> Float64[np.ndarray, "*batch 14"]:
    """Return the length of each of :data:`LIMBS` [m].

    Examples
    --------
    >>> standing_m = np.zeros((17, 3))
    >>> standing_m[COCO17.index("left_knee")] = [0.0, 0.3, 0.4]
    >>> dict(zip(LIMBS, limb_lengths(standing_m).tolist()))["left shin"]
    0.5
    """
    start_m, end_m = (xyz_m[..., ends, :].astype(np.float64) for ends in _ENDS.T)
    return np.asarray(np.linalg.norm(end_m - start_m, axis=-1))


@dataclass(frozen=True, slots=True, eq=False)
class LimbSeries:
    """Limb lengths of one person over time.

    Attributes
    ----------
    person
        The identity.
    t_s
        Times of the frames [s].
    length_m
        In the order of :data:`LIMBS`; NaN where an end is unknown [m].
    supported
        Whether a camera supports both ends.
    """

    person: int
    t_s: Float64[np.ndarray, " time"]
    length_m: Float64[np.ndarray, "time 14"]
    supported: Bool[np.ndarray, "time 14"]


def limb_series(people: Iterable[PersonTrack]) -> tuple[LimbSeries, ...]:
    """Return the limb lengths of all people over time."""
    return tuple(
        LimbSeries(
            track.person,
            track.t_s,
            limb_lengths(track.xyz_m),
            np.asarray((track.support[:, _ENDS] > 0).all(axis=-1)),
        )
        for track in people
    )


@dataclass(frozen=True, slots=True)
class LimbRow:
    """One limb of one person over a recording.

    Attributes
    ----------
    person
        The identity.
    limb
        One of :data:`LIMBS`.
    n
        Number of frames.
    mean_m, sd_m
        Mean and standard deviation of the length [m]; NaN without any.
    given_m
        True length [m]; NaN if unknown.
    """

    person: int
    limb: str
    n: int
    mean_m: float
    sd_m: float
    given_m: float

    @property
    def difference_m(self) -> float:
        """Mean length minus the true one [m]; NaN if either is unknown."""
        return self.mean_m - self.given_m

    @property
    def difference_share(self) -> float:
        """The difference as a share of the true length; NaN if that is unknown."""
        return self.difference_m / self.given_m if self.given_m > 0 else float("nan")

    def row(self) -> dict[str, str | float]:
        """Return the figures as a row of a table."""
        return {
            "person": self.person,
            "limb": self.limb,
            "n": self.n,
            "mean_cm": 100 * self.mean_m,
            "sd_cm": 100 * self.sd_m,
            "given_cm": 100 * self.given_m,
            "difference_cm": 100 * self.difference_m,
            "difference_percent": 100 * self.difference_share,
        }


def limb_table(series: Iterable[LimbSeries], given: Given | None = None) -> tuple[LimbRow, ...]:
    """Return mean and standard deviation of all limb lengths, as in the thesis' table 2.

    Only frames count in which a camera supports both ends. `given` are true lengths where known.
    """
    return tuple(row for one in series for row in _rows(one, (given or {}).get(one.person)))


def _rows(series: LimbSeries, given_m: Float64[np.ndarray, "14"] | None) -> Iterator[LimbRow]:
    counts = np.isfinite(series.length_m) & series.supported
    for index, limb in enumerate(LIMBS):
        length_m = series.length_m[counts[:, index], index]
        known = length_m if len(length_m) else np.full(1, np.nan)
        true_m = float("nan") if given_m is None else float(given_m[index])
        yield LimbRow(
            series.person, limb, len(length_m), float(known.mean()), float(known.std()), true_m
        )


@dataclass(frozen=True, slots=True)
class LimbSummary:
    """Mean figures over all limbs and people, weighted by the number of frames.

    Attributes
    ----------
    people
        Number of people with a limb.
    sd_m
        Mean standard deviation of a limb's length [m].
    difference_m
        Mean absolute difference from the true lengths [m]; NaN if none is known.
    """

    people: int
    sd_m: float
    difference_m: float

    def row(self) -> dict[str, float]:
        """Return the figures as a row of a table."""
        return {
            "people": self.people,
            "limb_sd_cm": 100 * self.sd_m,
            "limb_difference_cm": 100 * self.difference_m,
        }


def limb_summary(rows: Sequence[LimbRow]) -> LimbSummary:
    """Summarise a table."""
    counted = [row for row in rows if row.n]
    compared = [row for row in counted if np.isfinite(row.difference_m)]
    return LimbSummary(
        len({row.person for row in counted}),
        _weighted([row.sd_m for row in counted], counted),
        _weighted([abs(row.difference_m) for row in compared], compared),
    )


def _weighted(values: Sequence[float], rows: Sequence[LimbRow]) -> float:
    return float(np.average(values, weights=[row.n for row in rows])) if rows else float("nan")


def true_lengths(people: Iterable[PersonTrack], truth: Truth) -> Given:
    """Return the true limb lengths of each identity that is the track of a true person.

    A true length is the mean over the ground truth. An identity belongs to the person that is
    nearest in most frames, within 0.5 m, mean over the joints.
    """
    of_person = np.array(
        [mean_of_known(limb_lengths(xyz_m), axis=0) for xyz_m in truth.xyz_m]
    ).reshape(-1, len(LIMBS))
    found = {track.person: _whose(track, truth) for track in people}
    return {identity: of_person[number] for identity, number in found.items() if number is not None}


def _whose(track: PersonTrack, truth: Truth) -> int | None:
    """Return the number of the true person of a track, or None."""
    some = np.unique(np.linspace(0, len(track.t_s) - 1, _MOST_MOMENTS).astype(np.int64))
    some = some[(track.t_s[some] >= truth.t_s[0]) & (track.t_s[some] <= truth.t_s[-1])]
    after = np.searchsorted(truth.t_s, track.t_s[some]).clip(0, len(truth.t_s) - 1)
    before = (after - 1).clip(0)
    closer = track.t_s[some] - truth.t_s[before] < truth.t_s[after] - track.t_s[some]
    true_m = truth.xyz_m[:, np.where(closer, before, after)]
    apart_m = np.linalg.norm(true_m - track.xyz_m[some], axis=-1)
    mean_m = np.nan_to_num(mean_of_known(apart_m, axis=-1), nan=np.inf)
    near = mean_m.min(axis=0, initial=np.inf) < _NEAR_M
    if not near.any():
        return None
    return int(np.bincount(mean_m.argmin(axis=0)[near]).argmax())
