"""How wrong 2D key points are, where it is known what the images show.

The limb joints only: what estimators call an ear is marked by nobody. *Height* is that of a
person's limb joints in the image, from the uppermost to the lowest.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from jaxtyping import Bool, Float64, Int64, Shaped

from trecsim.lab.evaluation.assignment import best_pairs
from trecsim.skeleton import COCO17
from trecsim.values import Poses2D

LIMBS = slice(5, 17)
TYPES = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
ENOUGH_JOINTS = 9  # of twelve in the image: such a person should be found
GATE = 0.33  # nobody's key points are wrong by so much of the height, in the middle
FEWEST_JOINTS = 4
BOUND = 0.15  # larger errors are left out where processes in time are looked at
SWAPPED = 0.6  # with left and right exchanged, errors fall below that share
MIRROR = [joint - 5 for joint in COCO17.mirror[5:]]
FEWEST_TO_COMPARE = 6
BANDS = ((0.8, 1.0), (0.6, 0.8), (0.4, 0.6))
LAGS = (1, 2, 5, 10, 25)


@dataclass(frozen=True, slots=True, eq=False)
class Sights:
    """People in images, one row for each of them in each image.

    Attributes
    ----------
    who
        A number for every pair of camera and person.
    frame
        Number of the image in its camera.
    truth_px
        Where the limb joints are [px].
    inside
        Which of them are in the image.
    found_px
        Where they were found, NaN where missing [px].
    score
        Confidence, 0 where missing.
    """

    who: Int64[np.ndarray, " sight"]
    frame: Int64[np.ndarray, " sight"]
    truth_px: Float64[np.ndarray, "sight 12 2"]
    inside: Bool[np.ndarray, "sight 12"]
    found_px: Float64[np.ndarray, "sight 12 2"]
    score: Float64[np.ndarray, "sight 12"]

    @property
    def height_px(self) -> Float64[np.ndarray, " sight"]:
        """Height of the limb joints in the image [px]."""
        height_px: Float64[np.ndarray, " sight"] = np.ptp(self.truth_px[..., 1], axis=1)
        return height_px

    @property
    def error_px(self) -> Float64[np.ndarray, "sight 12 2"]:
        """What is found less what is true, of joints in the image; otherwise NaN [px]."""
        return np.where(self.inside[..., None], self.found_px - self.truth_px, np.nan)


def sights_of(
    camera: int,
    frame: int,
    size_px: tuple[int, int],
    truth_px: Float64[np.ndarray, "person 12 2"],
    poses: Poses2D,
) -> Sights:
    """Return who is seen in one image: people and what was found, paired.

    Parameters
    ----------
    camera, frame
        Numbers of the camera and of its image.
    size_px
        Of the image (width, height) [px].
    truth_px
        Limb joints of everybody, NaN of the absent [px].
    poses
        What was found.
    """
    in_image = (truth_px >= 0) & (truth_px <= np.array(size_px) - 1)
    inside: Bool[np.ndarray, "person 12"] = in_image[..., 0] & in_image[..., 1]
    found_px = np.full(truth_px.shape, np.nan)
    score = np.zeros(truth_px.shape[:2])
    limbs_px = poses.xy_px[:, LIMBS]
    error_px = np.linalg.norm(limbs_px - truth_px[:, None], axis=-1)
    cost = median_of_known(error_px) / np.ptp(truth_px[..., 1], axis=1)[:, None]
    for person, detection in best_pairs(cost, GATE):
        found_px[person] = limbs_px[detection]
        score[person] = poses.score[detection, LIMBS]
    here = np.logical_or.reduce(inside, axis=1)
    people = np.flatnonzero(here)
    return Sights(
        1000 * camera + people,
        np.full(len(people), frame),
        truth_px[here],
        inside[here],
        found_px[here],
        score[here],
    )


def median_of_known(
    error_px: Float64[np.ndarray, "row column 12"],
) -> Float64[np.ndarray, "row column"]:
    """Return the median of what is known; NaN where too little is."""
    known = np.isfinite(error_px).sum(axis=-1)
    ordered = np.sort(error_px, axis=-1)  # NaN come last
    at = np.maximum(known // 2, 0)[..., None]
    middle = np.take_along_axis(ordered, at, axis=-1)[..., 0]
    return np.where(known >= FEWEST_JOINTS, middle, np.nan)


def together(parts: Sequence[Sights]) -> Sights:
    """Return all sights as one.

    Parameters
    ----------
    parts
        At least one.
    """
    return Sights(
        *(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Sights))
    )


def figures(stills: Sights, bursts: Sights) -> dict[str, float]:
    """Return what tells a detector's habits, by name; NaN where nothing tells it.

    Parameters
    ----------
    stills
        Of many images, best far apart in time.
    bursts
        Of images that follow each other; may be the same.
    """
    found = np.isfinite(stills.found_px[..., 0]).any(axis=1)
    possible = stills.inside.sum(axis=1) >= ENOUGH_JOINTS
    values = {"person found": _mean(found[possible])}
    values |= _of_joints(stills, found)
    values |= _of_scores(stills)
    values |= _over_time(bursts)
    values["left and right swapped"] = _mean(_swapped(stills)[found])
    return values


def _of_joints(sights: Sights, found: Bool[np.ndarray, " sight"]) -> dict[str, float]:
    size_px = np.linalg.norm(sights.error_px, axis=-1)
    values = {}
    for number, name in enumerate(TYPES):
        both = slice(2 * number, 2 * number + 2)
        inside = sights.inside[found, both]
        values[f"{name} missing"] = _mean(np.isnan(size_px[found, both])[inside])
        for percent, px in zip((50, 90, 99), _quantiles(size_px[:, both]), strict=True):
            values[f"{name} error p{percent} px"] = px
    for percent, share in zip(
        (50, 90, 99), _quantiles(size_px / sights.height_px[:, None]), strict=True
    ):
        values[f"error p{percent} of height"] = share
    return values


def _mean(values: Shaped[np.ndarray, "..."]) -> float:
    return float(values.mean()) if values.size else np.nan


def _quantiles(values: Float64[np.ndarray, "..."]) -> tuple[float, float, float]:
    known = values[np.isfinite(values)]
    if not known.size:
        return np.nan, np.nan, np.nan
    middle, high, highest = np.quantile(known, (0.5, 0.9, 0.99))
    return float(middle), float(high), float(highest)


def _of_scores(sights: Sights) -> dict[str, float]:
    size_px = np.linalg.norm(sights.error_px, axis=-1)
    return {
        f"error p50 px, score {least} to {most}": _quantiles(
            size_px[(sights.score > least) & (sights.score <= most)]
        )[0]
        for least, most in BANDS
    }


def _over_time(sights: Sights) -> dict[str, float]:
    error_px = sights.error_px
    share = np.linalg.norm(error_px, axis=-1) / sights.height_px[:, None]
    error_px[~(share < BOUND)] = np.nan
    key = sights.who * 10**9 + sights.frame
    order = np.argsort(key)
    values = {}
    for lag in LAGS:
        place = np.searchsorted(key[order], key + lag).clip(max=len(key) - 1)
        later = order[place]
        pairs = key[later] == key + lag
        first, second = error_px[pairs], error_px[later[pairs]]
        both = np.isfinite(first) & np.isfinite(second)
        first, second = first[both], second[both]
        scale = np.sqrt(_mean(first**2) * _mean(second**2))
        product = _mean(first * second)
        values[f"correlation over {lag}"] = float(product / scale) if scale > 0 else np.nan
        if lag == 1:
            change_px = _quantiles(np.abs(second - first))[0]
            values["white part px"] = float(1.4826 * change_px / np.sqrt(2.0))
    return values


def _swapped(sights: Sights) -> Bool[np.ndarray, " sight"]:
    """Return whom left and right exchanged would fit much better."""
    as_is = np.linalg.norm(sights.found_px - sights.truth_px, axis=-1)
    exchanged = np.linalg.norm(sights.found_px[:, MIRROR] - sights.truth_px, axis=-1)
    both = np.isfinite(as_is) & np.isfinite(exchanged)
    if_exchanged, now = (np.where(both, size, 0.0).sum(axis=1) for size in (exchanged, as_is))
    swapped: Bool[np.ndarray, " sight"] = if_exchanged < SWAPPED * now
    swapped &= both.sum(axis=1) >= FEWEST_TO_COMPARE
    return swapped
