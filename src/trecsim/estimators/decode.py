"""From the numbers that a network puts out to people, in pixels of its input.

One pure function per layout. Key points come with pixel centres at integers; scores that are no
numbers count as 0, positions that are no numbers as missing.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Float64, Int64

from trecsim.estimators.letterbox import Letterbox, Size
from trecsim.values import LOOK_DIGITS, Poses2D

JOINTS = 17

# How far annotators disagree per joint, relative to the size of the person (COCO's constants).
_SIGMA = np.array(
    [
        *[0.026, 0.025, 0.025, 0.035, 0.035, 0.079, 0.079, 0.072, 0.072, 0.062, 0.062],
        *[0.107, 0.107, 0.087, 0.087, 0.089, 0.089],
    ]
)
# MoveNet's positions lie a quarter of a pixel to the right of where mirroring the image says they
# should (median over four cameras, inputs of 256, 384 and 512 pixels: 0.13, 0.30, 0.23).
_MOVENET_SHIFT_PX = 0.25
_MOST_CANDIDATES = 300  # comparing all with all must not take for ever on a bad image
_SAME_PERSON = 0.6  # OKS
_SAME_BOX = 0.7  # of two boxes, relative to what they cover together
_COVERS = 0.4  # in the same measure
_FEWEST_SHARED_JOINTS = 3  # fewer say nothing about whether two skeletons are one person


@dataclass(frozen=True, slots=True, eq=False)
class Detections:
    """People as a network puts them out, best first.

    Attributes
    ----------
    xy_px
        Key points [px], of the network's input or of the image.
    score
        Per key point, 0 to 1.
    person_score
        Per person, 0 to 1.
    box_px
        Left, top, right, bottom [px].
    pixel_px
        Size of a pixel of the network's input where it found each [px].
    """

    xy_px: Float64[np.ndarray, "person joint 2"]
    score: Float64[np.ndarray, "person joint"]
    person_score: Float64[np.ndarray, " person"]
    box_px: Float64[np.ndarray, "person 4"]
    pixel_px: Float64[np.ndarray, " person"]

    def __len__(self) -> int:
        return len(self.person_score)

    def take(self, index: Int64[np.ndarray, " kept"]) -> "Detections":
        """Return the people at `index`, in that order."""
        return Detections(
            self.xy_px[index], self.score[index], self.person_score[index], self.box_px[index],
            self.pixel_px[index],
        )  # fmt: skip

    def first(self, count: int) -> "Detections":
        """Return the best `count` people."""
        return self.take(np.arange(min(count, len(self)), dtype=np.int64))

    def in_image(self, box: Letterbox) -> "Detections":
        """Return the people in pixels of the image that `box` fits into the input."""
        corners = box.to_image(self.box_px.reshape(-1, 2, 2)).reshape(-1, 4)
        pixel_px = self.pixel_px * (max(box.image_px) / max(box.scaled_px))
        return replace(self, xy_px=box.to_image(self.xy_px), box_px=corners, pixel_px=pixel_px)


NOBODY = Detections(
    np.empty((0, JOINTS, 2)), np.empty((0, JOINTS)), np.empty(0), np.empty((0, 4)), np.empty(0)
)


def movenet(out: Float[np.ndarray, "1 person 56"], input_px: Size) -> Detections:
    """Decode MoveNet MultiPose: 17 x (y, x, score), then ymin, xmin, ymax, xmax, score.

    Parameters
    ----------
    out
        Positions are relative to the input.
    input_px
        (width, height) of the input.
    """
    rows = _rows(out, 56)
    joints = rows[:, :51].reshape(-1, JOINTS, 3)
    xy_px = joints[..., [1, 0]] * input_px - _MOVENET_SHIFT_PX
    box_px = rows[:, [52, 51, 54, 53]] * (*input_px, *input_px)
    return detections(xy_px, joints[..., 2], rows[:, 55], box_px)


def yolo_raw(out: Float[np.ndarray, "1 56 candidate"]) -> Detections:
    """Decode YOLOv8-pose and YOLO11-pose before suppression: box centre and size, score, joints."""
    rows = _rows(np.swapaxes(np.asarray(out), 1, 2), 56)
    return _best_boxes(_yolo(rows, _corners(rows[:, :4]), rows[:, 4], rows[:, 5:]))


def yolov7_raw(out: Float[np.ndarray, "1 candidate 57"]) -> Detections:
    """Decode YOLOv7-pose before suppression: box centre and size, object, class score, joints."""
    rows = _rows(out, 57)
    score = rows[:, 4] * rows[:, 5]
    return _best_boxes(_yolo(rows, _corners(rows[:, :4]), score, rows[:, 6:]))


def yolo_end_to_end(out: Float[np.ndarray, "*batch person 57"]) -> Detections:
    """Decode models that suppress by themselves: box corners, score, class, joints."""
    rows = _rows(out, 57)
    return _yolo(rows, rows[:, :4], rows[:, 4], rows[:, 6:])


def rtmo(
    dets: Float[np.ndarray, "1 box 5"], joints: Float[np.ndarray, "1 person 17 3"]
) -> Detections:
    """Decode RTMO: boxes with a score, and key points with theirs, in two arrays."""
    boxes = _rows(dets, 5)
    people = _rows(joints, JOINTS * 3).reshape(len(boxes), JOINTS, 3)
    return detections(people[..., :2], people[..., 2], boxes[:, 4], boxes[:, :4])


def choose(found: Detections, min_person_score: float, max_people: int) -> Detections:
    """Return the best people: those that score enough, each of them once.

    Parameters
    ----------
    found
        What a decoder returned.
    min_person_score
        Who scores less is left out.
    max_people
        At most so many.
    """
    good = found.take(np.flatnonzero(found.person_score >= min_person_score)[:_MOST_CANDIDATES])
    return good.take(suppress(similarity(good), _SAME_PERSON)[:max_people])


def suppress(alike: Float64[np.ndarray, "person person"], limit: float) -> Int64[np.ndarray, " k"]:
    """Return the indices of those who are not too much like anybody better.

    Parameters
    ----------
    alike
        How much each is like each other, 0 to 1; the better ones come first.
    limit
        From here on two are taken for one.
    """
    kept: list[int] = []
    for person in range(len(alike)):
        if not kept or alike[person, kept].max() < limit:
            kept.append(person)
    return np.array(kept, np.int64)


def overlap(box_px: Float64[np.ndarray, "person 4"]) -> Float64[np.ndarray, "person person"]:
    """Return the area that two boxes share, relative to what they cover together."""
    low = np.maximum(box_px[:, None, :2], box_px[None, :, :2])
    high = np.minimum(box_px[:, None, 2:], box_px[None, :, 2:])
    shared = np.prod(np.clip(high - low, 0, None), axis=-1)
    area = _area(box_px)
    union = area[:, None] + area - shared
    ratio: Float64[np.ndarray, "person person"] = np.where(
        union > 0, shared / np.where(union > 0, union, 1.0), 0.0
    )
    return ratio


def similarity(found: Detections) -> Float64[np.ndarray, "person person"]:
    """Return how alike the skeletons are: COCO's object keypoint similarity (OKS).

    Notes
    -----
    ``mean over joints of exp(-d^2 / (2 area (2 sigma_j)^2))``, over the joints that both have; the
    area is that of the larger box. Skeletons that share too few joints count as different.
    """
    distance2 = np.sum((found.xy_px[:, None] - found.xy_px[None]) ** 2, axis=-1)
    area = _area(found.box_px)
    scale2 = 2.0 * np.maximum(np.maximum(area[:, None], area), 1.0)[..., None] * (2 * _SIGMA) ** 2
    seen = (found.score > 0) & np.isfinite(found.xy_px).all(axis=-1)
    shared: Bool[np.ndarray, "person person joint"] = seen[:, None] & seen[None]
    near = np.where(shared, np.exp(-np.where(shared, distance2, 0.0) / scale2), 0.0).sum(axis=-1)
    count = shared.sum(axis=-1)
    return np.where(count >= _FEWEST_SHARED_JOINTS, near / np.maximum(count, 1), 0.0)


def complete(first: Detections, second: Detections) -> Detections:
    """Return the people of one look at an image, and those of a second who were missed.

    Parameters
    ----------
    first
        All of these are taken.
    second
        Of these, who does not cover anybody of `first`: a second skeleton of somebody who is there
        already would do more harm than good.
    """
    both = _concatenated(first, second)
    covers = overlap(both.box_px)[len(first) :, : len(first)]
    missed = covers.max(axis=1, initial=0.0) < _COVERS
    added = len(first) + np.flatnonzero(missed)
    return _best_first(both.take(np.append(np.arange(len(first)), added)))


def better(first: Detections, second: Detections) -> Detections:
    """Return the people of two looks that are equally fine; of two that cover each other, the best.

    An upright look makes a poor skeleton of somebody who lies, where a turned one makes a good one.
    """
    both = _best_first(_concatenated(first, second))
    return both.take(suppress(overlap(both.box_px), _COVERS))


def to_poses(found: Detections, min_joint_score: float, camera: str, t_s: float) -> Poses2D:
    """Return the people as they leave an estimator; key points that score too little are missing.

    Who has none left is left out.
    """
    seen = found.score >= max(min_joint_score, np.finfo(float).tiny)
    seen &= np.isfinite(found.xy_px).all(axis=-1)
    someone = seen.any(axis=1)
    return Poses2D(
        camera=camera,
        t_s=t_s,
        xy_px=np.where(seen[..., None], found.xy_px, np.nan)[someone],
        score=np.where(seen, found.score, 0.0)[someone],
        person_score=found.person_score[someone],
        pixel_px=found.pixel_px[someone].round(LOOK_DIGITS),
    )


def _rows(out: Float[np.ndarray, "..."], columns: int) -> Float64[np.ndarray, "person column"]:
    rows = np.asarray(out, np.float64).reshape(-1, columns)
    return np.where(np.isfinite(rows), rows, np.nan)  # which pass through all that follows


def _corners(centre: Float64[np.ndarray, "person 4"]) -> Float64[np.ndarray, "person 4"]:
    half = centre[:, 2:] / 2
    return np.hstack([centre[:, :2] - half, centre[:, :2] + half])


def _yolo(
    rows: Float64[np.ndarray, "person column"],
    box_px: Float64[np.ndarray, "person 4"],
    person_score: Float64[np.ndarray, " person"],
    joints: Float64[np.ndarray, "person 51"],
) -> Detections:
    people = joints.reshape(len(rows), JOINTS, 3)
    # YOLO counts from the corner of the first pixel, not from its centre.
    return detections(people[..., :2] - 0.5, people[..., 2], person_score, box_px - 0.5)


def _best_boxes(found: Detections) -> Detections:
    """Return the best of the many boxes that such a network has for each person."""
    best = found.first(_MOST_CANDIDATES)
    return best.take(suppress(overlap(best.box_px), _SAME_BOX))


def detections(
    xy_px: Float64[np.ndarray, "person joint 2"],
    score: Float64[np.ndarray, "person joint"],
    person_score: Float64[np.ndarray, " person"],
    box_px: Float64[np.ndarray, "person 4"],
) -> Detections:
    """Return people best first; what is no number counts as a score of 0."""
    found = Detections(
        xy_px=xy_px,
        score=np.clip(np.nan_to_num(score, nan=0.0), 0.0, 1.0),
        person_score=np.clip(np.nan_to_num(person_score, nan=0.0), 0.0, 1.0),
        box_px=np.nan_to_num(box_px, nan=0.0),
        pixel_px=np.ones(len(person_score)),
    )
    return _best_first(found)


def _best_first(found: Detections) -> Detections:
    return found.take(np.argsort(-found.person_score, kind="stable").astype(np.int64))


def _concatenated(a: Detections, b: Detections) -> Detections:
    return Detections(
        np.concatenate([a.xy_px, b.xy_px]),
        np.concatenate([a.score, b.score]),
        np.concatenate([a.person_score, b.person_score]),
        np.concatenate([a.box_px, b.box_px]),
        np.concatenate([a.pixel_px, b.pixel_px]),
    )


def _area(box_px: Float64[np.ndarray, "person 4"]) -> Float64[np.ndarray, " person"]:
    area: Float64[np.ndarray, " person"] = np.prod(
        np.clip(box_px[:, 2:] - box_px[:, :2], 0, None), axis=-1
    )
    return area
