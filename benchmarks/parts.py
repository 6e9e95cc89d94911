"""The parts of the fusion's model, and how each is switched off.

To add one, add a `Part` to `PARTS`. Take a setting's limiting value where that is exactly "off",
else change the `Model`, else replace a function or a constant (`harness/switching.py`).
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from statistics import geometric_mean
from typing import Any

import numpy as np

from harness.switching import replaced
from trecsim.fusion import FusionSettings
from trecsim.fusion import model as fusion_model
from trecsim.fusion.images import Images, prepare
from trecsim.fusion.kernels import Bones, Views
from trecsim.fusion.model import Model

FULL = "the full model"
ACCELS = ("accel_torso", "accel_head", "accel_arm", "accel_leg")
NEVER, ALWAYS = 1e-9, 1e9  # as times, lengths, shares: so little or much that it is none or all


@dataclass(frozen=True, slots=True)
class Part:
    """One part of the model, and how it is switched off.

    Attributes
    ----------
    name
        Of the part.
    instead
        What happens without it.
    settings
        Settings of the fusion that switch it off.
    model
        What makes a `Model` without it.
    changes
        What is replaced in the fusion; see `harness.switching.replaced`.
    lag_s
        How far behind the newest image people are reported [s].
    """

    name: str
    instead: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    model: Callable[[Model], Model] | None = None
    changes: Mapping[str, Any] = field(default_factory=dict)
    lag_s: float = 0.0

    @contextmanager
    def off(self) -> Iterator[None]:
        """Switch the part off while the context lasts, but for what its settings do."""
        changes = dict(self.changes)
        if self.model is not None:
            changes["model.build"] = _built(self.model)
        with replaced(self.name, changes):
            yield


def _built(change: Callable[[Model], Model]) -> Callable[..., Model]:
    build = fusion_model.build

    def changed(*arguments: Any) -> Model:
        return change(build(*arguments))

    return changed


# What takes the place of a function: never true, always true, nothing done, nothing of it.


def _no(*_: Any) -> bool:
    return False


def _nothing(*_: Any) -> None:
    pass


def _on_no_ground(*_: Any) -> tuple[int, float, float]:
    return -1, 0.0, 1.0


def _none(*_: Any) -> float:
    return 0.0


def _inlier(*_: Any) -> float:
    return 1e300  # odds


def _all(*_: Any) -> float:
    return 1.0


def _two_cameras(people: Any, *_: Any) -> Any:
    n, n_cam = people.last_seen_s.shape
    return Views(np.full(n, 2, np.int64), np.zeros(n, bool), np.zeros((n, n_cam), bool))


def _all_trusted(two_view_s: Any, _swap_evidence: Any) -> Any:
    return np.full(two_view_s.shape, np.inf)


def _at_one_time(*arguments: Any) -> Images:
    images = prepare(*arguments)
    return replace(images, t_s=np.full(len(images), images.t_s.max(initial=-np.inf)))


def _same_noise(model: Model) -> Model:
    mean_m = np.full_like(model.noise.sigma_m, model.noise.sigma_m.mean())
    return replace(model, noise=model.noise._replace(sigma_m=mean_m))


def _no_limbs(model: Model) -> Model:
    slack_m2 = np.full_like(model.limbs.slack_m2, ALWAYS)
    return replace(model, limbs=model.limbs._replace(slack_m2=slack_m2))


def _no_bones(model: Model) -> Model:
    return replace(model, bones=Bones(*(values[:0].copy() for values in model.bones)))


PARTS: dict[str, tuple[Part, ...]] = {
    "key points and detections": (
        Part("outliers among a person's key points",
             "every key point of a detection that is the person's shows its joint",
             changes={"kernels.locating.inlier_odds": _inlier}),
        Part("heavy tails", "errors of inliers are Gaussian", {"tail_freedom": 1e6}),
        Part("outliers and heavy tails", "both of these",
             {"tail_freedom": 1e6}, changes={"kernels.locating.inlier_odds": _inlier}),
        Part("outliers in the association, too",
             "both, and a detection is all of a person or nothing",
             {"tail_freedom": 1e6, "outlier_share": 1e-100},
             changes={"kernels.locating.inlier_odds": _inlier}),
        Part("scores as noise", "a low score means nothing", {"good_score": NEVER}),
        Part("least score", "no key point is left out for its score", {"min_score": NEVER}),
        Part("people found twice in an image", "both detections stay",
             changes={"kernels.prefilter.are_duplicates": _no}),
        Part("persistence of errors", "every image tells something new",
             {"error_memory_s": NEVER}),
        Part("lasting errors in what is stated", "trajectories are as sure as they seem",
             {"bias_share": NEVER}),
        Part("quick errors apart", "all of a key point's error is new in each image",
             {"white_share": 1.0}),
        Part("noise by joint", "a hip is as easy to find as an elbow", model=_same_noise),
        Part("both readings of left and right", "no detection is ever read exchanged",
             {"flip_share": 1e-300}),
        Part("mirrored people turned round", "who began mirrored stays mirrored",
             changes={"evidence.unmirror": _nothing}),
        Part("soft responsibilities of people", "a detection is wholly the person's it goes to",
             changes={"kernels.matching.responsibility": _all}),
        Part("tempered responsibilities", "17 key points are worth 17 independent ones",
             changes={"kernels.matching.TEMPER": 1.0}),
        Part("EM steps", "one step instead of three",
             changes={"kernels.locating.EM_STEPS": 1}),
    ),
    "motion": (
        Part("sharp turns", "what is known of a body that turns stays as sure as it was",
             changes={"kernels.fitting_kernels.NIS_GATE": ALWAYS}),
        Part("leeway for turns", "key points are judged by the prediction's own variance",
             changes={"kernels.mixture.LEEWAY": 0.0}),
        Part("stiffness by joint", "head, torso, arms and legs bend alike",
             dict.fromkeys(ACCELS, geometric_mean(getattr(FusionSettings(), a) for a in ACCELS))),
        Part("velocity of the body", "a joint keeps its own velocity for ever",
             {"velocity_memory_s": ALWAYS}),
        Part("drag-along", "so does a joint that nobody sees", {"coasting_memory_s": ALWAYS}),
        Part("each image at its own time", "all images of a set are taken as its newest",
             changes={"images.prepare": _at_one_time}),
        Part("knots every 0.1 s", "every 0.2 s", {"knot_s": 0.2}),
        Part("live part of 0.5 s", "of 0.2 s: what is older is marginalised", {"window_s": 0.2}),
    ),
    "the body": (
        Part("lengths of limbs", "nothing holds a body together", model=_no_limbs),
        Part("lengths hold joints that cameras see", "only those that fewer than two see",
             changes={"kernels.reported_covariance.tighten": _nothing}),
        Part("lengths hold joints that few cameras see", "only those that two or more see",
             changes={"kernels.anatomy.relax_body": _nothing}),
        Part("the body's opinion is not news", "all that it says is new information each time",
             changes={"kernels.anatomy.BODY_S": NEVER}),
        Part("the ground", "what one camera sees may float or sink",
             changes={"kernels.anatomy.ground_contact": _on_no_ground}),
        Part("lengths learnt per person", "everybody is of usual size",
             changes={"kernels.lengths.learn": _nothing}),
    ),
    "coming and going": (
        Part("anatomy of newcomers", "rays that meet are enough", model=_no_bones),
        Part("other cameras join newcomers", "a person begins with two cameras",
             changes={"birth._absorb": _nothing}),
        Part("confirmation", "everybody is reported at once", {"confirm_s": NEVER}),
        Part("three cameras at once", "they too must agree for `confirm_s`",
             changes={"kernels.presence.SURE_CAMERAS": ALWAYS}),
        Part("two cameras sure at once", "they too must agree for `confirm_s`",
             changes={"birth.SURE_BIRTH_SCORE": ALWAYS}),
        Part("expected visibility", "it never matters how many cameras should see somebody",
             changes={"lifecycle.expected_cameras": _two_cameras}),
        Part("people hidden by others", "a camera should find those, too",
             changes={"kernels.visibility_kernels.hidden_share": _none}),
        Part("doubt", "a single supporting camera keeps a track alive",
             {"single_view_death_s": ALWAYS}),
        Part("lonely people looked at again", "whom one camera sees stays where it is",
             changes={"kernels.updating.trusted_two_view_s": _all_trusted}),
        Part("recall", "nobody gets an old identity back", {"reidentify_s": NEVER}),
        Part("duplicates", "two tracks of one person both stay", {"duplicate_m": NEVER}),
    ),
    "a lag, which the full model does without": (
        Part("0.08 s lag", "people as they were 0.08 s ago", lag_s=0.08),
        Part("0.2 s lag", "people as they were 0.2 s ago", lag_s=0.2),
    ),
}  # fmt: skip
"""All parts, in groups."""


def by_name() -> dict[str, Part]:
    """Return the full model and all parts by name."""
    parts = (Part(FULL, ""), *(part for group in PARTS.values() for part in group))
    return {part.name: part for part in parts}
