"""Figures of other programs that were recorded once and are not measured again here.

The thesis' own stand in its section 4.4 (its author's computer). Those of the thesis author's
program on the scenes of `thesis.py` come from the same key points. Those on Shelf come from the
same detections, frames (all 301) and protocol as ours, unless marked as published.
"""

from typing import NamedTuple

# The thesis' table 5, parameter set 1, ms per fit: mean, standard deviation, max, min.
THESIS_FIT_MS = {
    1: (0.74, 0.23, 1.20, 0.35),
    2: (1.86, 0.31, 4.41, 0.80),
    3: (4.40, 0.48, 8.46, 3.35),
}
# The thesis' table 7, YOLOv7 on its author's GPU, ms per image: mean, standard deviation, max, min.
THESIS_INFERENCE_MS = {
    1: (11.36, 5.61, 53.15, 8.93),
    2: (11.39, 6.33, 93.12, 9.03),
    3: (10.57, 1.69, 23.50, 9.29),
}
# Our default estimator on a processor with AVX2 but neither AVX-512 nor bfloat16, images of four
# cameras of 1080 x 1920 with two people: processor time per image, median.
ESTIMATOR_AVX2_MS = 135.0
# The thesis author's program, run on a server processor like ours, two cameras: ms per fit.
AUTHORS_FIT_MS = {1: 1.6, 2: 4.7, 3: 6.6, 4: 13.6, 6: 34.6}
AUTHORS_GROWTH = 1.75  # about this power of the people


class BesideAuthor(NamedTuple):
    """Ours and the thesis author's program, measured in turn in one run on the same key points."""

    scene: str
    built: str  # how the author's program was compiled
    ours_ms: float  # median per frame set
    theirs_ms: tuple[float, float]  # per fit, over the settings its author gives


# At commit ed2252f, one thread of a processor with avx2, least time of each step over the rounds.
BESIDE_AUTHOR = (
    BesideAuthor("2 cameras, 3 people", "-Ofast", 0.378, (9.36, 11.9)),
    BesideAuthor("4 cameras, 3 people", "-Ofast", 0.544, (8.13, 9.93)),
    BesideAuthor("2 cameras, 4 people", "-O3", 0.796, (18.5, 19.4)),
    BesideAuthor("2 cameras, 6 people", "-O3", 0.623, (30.9, 44.4)),
)


class AuthorsScene(NamedTuple):
    """What the thesis author's program reached on a scene; None where it was not recorded."""

    error_cm: float | None
    recall: float
    recall_best: float | None  # with the best parameters that were found
    switches: int | None


# Shares of joints within 15 cm, with the settings the program comes with.
AUTHORS_SCENES = {
    "walk_J1_C2": AuthorsScene(2.0, 1.00, None, None),
    "walk_J2_C2": AuthorsScene(10.2, 0.84, None, None),
    "walk_J3_C2": AuthorsScene(19.0, 0.15, 0.91, None),
    "hard_J3_C2": AuthorsScene(None, 0.29, 0.65, None),
    "cross_X_occl_C2": AuthorsScene(None, 0.51, 0.93, 8),
}


AUTHORS_CROWDED = {
    4: 0.08,
    6: 0.02,
}  # joints within 15 cm, so many people walking, with its settings


FEWER_ON_SHELF = {4: "93.8"}  # 4D Association, mean over all choices of so many cameras


class OnShelf(NamedTuple):
    """What another program reached on Shelf, five cameras; PCP in percent."""

    name: str
    actors: tuple[float, float, float] | None
    average: float
    actor4: float | None
    switches: int | None
    missed: int | None
    ms: str
    published: bool = False


ON_SHELF = (
    OnShelf("Pose2Sim 0.10.49", (90.9, 72.7, 97.0), 86.9, 80.6, 1, 15, "about 165"),
    OnShelf("4D Association (C++)", (99.6, 91.4, 98.0), 96.3, 92.4, 0, 0, "21.6"),
    OnShelf("4D Association, Louvain fork", (99.6, 96.2, 97.9), 97.9, 98.2, 0, 0, ""),
    OnShelf("a simple NumPy tracker, no lag", (99.8, 92.4, 97.6), 96.6, 94.9, 0, 0, "1.5"),
    OnShelf("best subset of views, chosen with the truth", None, 97.6, 95.2, None, None, ""),
    OnShelf("training-free methods, up to", None, 97.4, None, None, None, "", published=True),
    OnShelf("learned on the same scene, up to", None, 98.0, None, None, None, "", published=True),
)
