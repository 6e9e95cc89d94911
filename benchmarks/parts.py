"""The parts of the fusion's model, how each is switched off, and where it is measured.

To add one, add a `Part` to `PARTS`. Take a setting's limiting value where that is exactly "off",
else change the `Model`, else replace a function or a constant (`harness/switching.py`).
"""

from statistics import geometric_mean

import replacements as instead
from ablation_inputs import FOUR, TWO
from part import Part
from replacements import ALWAYS, NEVER
from trecsim.fusion import FusionSettings

FULL = "the full model"
ACCELS = ("accel_torso", "accel_head", "accel_arm", "accel_leg")


def by_name() -> dict[str, Part]:
    """Return the full model and all parts by name."""
    parts = [part for group in PARTS.values() for part in group]
    every = tuple(dict.fromkeys(aim for part in parts for aim in part.aims))
    return {part.name: part for part in (Part(FULL, "", every), *parts)}


# What parts are for, where several are for the same.
ERROR = (FOUR, "error")
LIKELIHOOD = (FOUR, "log-likelihood")
CROSSING = ("thesis, crossing", "error")
HARD = ("thesis, hard", "error")
WALKING = ("thesis, walking", "error")
PCP_5, PCP_2 = ("Shelf, 5 cameras", "average PCP"), ("Shelf, 2 cameras", "average PCP")
ON_SHELF = ("Shelf, 5 cameras", "log-likelihood")
PAIRS = ("real video, disjoint pairs", "log-likelihood")
IN_TURN = ("real video, cameras in turn", "step, median")
TURNED, LATE = ("a camera turned", "error"), ("a clock late", "error")
AT_8, AT_5 = ("8 images a second", "switches"), ("5 images a second", "switches")
LEAVERS = ("coming and going", "ghosts")
GONE = ("coming and going", "left, gone after")
PHANTOMS = ("phantoms of two cameras", "ghosts")
NEW, KNOWN = ("one camera, new", "log-likelihood"), ("one camera, known", "log-likelihood")
NEW_DEPTH, KNOWN_DEPTH = ("one camera, new", "off in depth"), ("one camera, known", "off in depth")
PROVISIONAL = ("a knocked camera", "ghosts, provisional people counted")
ALONE = ("coming and going", "missed, provisional people counted")
WRIST = ("a wrist in one view", "log-likelihood")
WRIST_ERROR = ("a wrist in one view", "error")

_INLIERS = {"kernels.locating.inlier_odds": instead.inlier}

PARTS: dict[str, tuple[Part, ...]] = {
    "key points and detections": (
        Part("outliers within a detection",
             "every key point of an associated detection shows its joint",
             (ERROR,), changes=_INLIERS),
        Part("heavy tails", "errors of inliers are Gaussian", (HARD,), {"tail_freedom": 1e6}),
        Part("outliers and heavy tails", "both of these", (ERROR,), {"tail_freedom": 1e6},
             changes=_INLIERS),
        Part("outliers in the association, too",
             "both, and a detection is all of a person or nothing",
             (("poor cameras", "switches"), ("poor cameras", "error")),
             {"tail_freedom": 1e6, "outlier_share": 1e-100},
             changes=_INLIERS),
        Part("noise by score", "a low score means nothing", (ERROR,), {"good_score": NEVER}),
        Part("least score", "no key point is left out for its score", (WALKING,),
             {"min_score": NEVER}),
        Part("duplicate detections", "two detections of one person in an image both stay", (PCP_5,),
             changes={"kernels.prefilter.are_duplicates": instead.no}),
        Part("correlation of errors in time", "every image tells something new", (PAIRS,),
             {"error_memory_s": NEVER}),
        Part("white share of the noise", "all of a key point's error is new in each image",
             (CROSSING,), {"white_share": 1.0}),
        Part("noise by joint", "a hip is as easy to find as an elbow", (ON_SHELF,),
             model=instead.same_noise),
        Part("left and right exchanged in a detection", "no detection is read exchanged",
             ((TWO, "error"),), {"flip_share": 1e-300}),
        Part("mirrored tracks turned round", "a track that began mirrored stays mirrored",
             ((TWO, "error"),), changes={"evidence.unmirror": instead.nothing}),
        Part("soft responsibilities of tracks", "a detection belongs wholly to its track",
             (("close together", "error"),),
             changes={"kernels.matching.responsibility": instead.all_}),
        Part("tempered responsibilities", "17 key points are worth 17 independent ones", (PCP_2,),
             changes={"kernels.matching.TEMPER": 1.0}),
        Part("EM steps", "one step instead of three", (CROSSING,),
             changes={"kernels.locating.EM_STEPS": 1}),
    ),
    "motion": (
        Part("covariance inflation in sharp turns", "a body that turns stays as certain as it was",
             (CROSSING,), changes={"kernels.fitting_kernels.NIS_GATE": ALWAYS}),
        Part("wider gate for turns", "key points are judged by the prediction's own variance",
             (CROSSING,), changes={"kernels.mixture.LEEWAY": 0.0}),
        Part("lasting camera errors are no turn",
             "innovations of a camera that does not fit inflate the covariance",
             (IN_TURN, CROSSING),
             changes={"kernels.fitting_kernels.nis_ratio_of_cameras": instead.nis_of_everything}),
        Part("recent offset of a camera is no turn",
             "of lasting camera errors, only the variance counts",
             (IN_TURN, CROSSING, ("8 images a second", "error")),
             changes={"kernels.presence.VIEW_OFFSET_S": ALWAYS}),
        Part("stiffness by joint", "head, torso, arms and legs bend alike", (PCP_5,),
             dict.fromkeys(ACCELS, geometric_mean(getattr(FusionSettings(), a) for a in ACCELS))),
        Part("velocity of the body", "a joint keeps its own velocity for ever",
             ((FOUR, "limbs' spread"),), {"velocity_memory_s": ALWAYS}),
        Part("drag-along", "so does a joint that no camera supports", (WRIST,),
             {"coasting_memory_s": ALWAYS}),
        Part("velocity decays before one camera", "it stays", (KNOWN_DEPTH,),
             changes={"kernels.body_motion.KEPT": 1.0}),
        Part("unseen people slow down", "people whom no camera sees keep their velocity",
             (LEAVERS, AT_5), changes={"kernels.body_motion.KEPT_UNSEEN": 1.0}),
        Part("each image at its own time", "all images of a set are taken as its newest", (ERROR,),
             changes={"images.prepare": instead.at_one_time}),
        Part("knots every 0.1 s", "every 0.2 s", (CROSSING,), {"knot_s": 0.2}),
        Part("live part of 0.5 s", "of 0.2 s: what is older is marginalised", (PCP_2,),
             {"window_s": 0.2}),
    ),
    "the body": (
        Part("usual directions of limbs", "the end of a limb that no camera sees drifts",
             ((TWO, "error"),), changes={"kernels.anatomy.add_directions": instead.nothing}),
        Part("other place of a limb", "its end stays before or behind the other end for good",
             (WRIST_ERROR, (TWO, "error")),
             model=instead.no_postures),
        Part("lengths of limbs", "nothing holds a body together", ((TWO, "error"), PCP_2),
             model=instead.no_limbs),
        Part("lengths hold joints that cameras see", "only those that fewer than two see", (ERROR,),
             changes={"kernels.reported_covariance.tighten": instead.nothing}),
        Part("lengths hold joints that few cameras see", "only those that two or more see",
             ((TWO, "error"), PCP_2), changes={"kernels.anatomy.relax_body": instead.nothing}),
        Part("message of the body counts once", "all of it is new information each time",
             (("one camera, sitting or lying", "log-likelihood"),),
             changes={"kernels.anatomy.BODY_S": NEVER}),
        Part("ground under weak joints", "what one camera sees may float or sink",
             ((TWO, "error"),),
             changes={"kernels.anatomy.ground_contact": instead.on_no_ground}),
        Part("lengths learnt per person", "everybody is of usual size", (WALKING,),
             changes={"kernels.lengths.learn": instead.nothing}),
    ),
    "stated uncertainty": (
        Part("bias", "the covariance of the trajectories is all that is stated", (LIKELIHOOD,),
             {"bias_share": 1e-3}),
        Part("common part", "errors that all cameras share are not stated",
             (ON_SHELF, LIKELIHOOD), {"common_sigma_m": NEVER}),
        Part("common part by joint", "it is the same for all joints", (ON_SHELF, LIKELIHOOD),
             model=instead.same_common),
        Part("disagreement", "a camera that shows the joint elsewhere changes nothing",
             ((TWO, "log-likelihood"), PAIRS),
             changes={"kernels.reported_covariance.disagreement_m2": instead.only_spread}),
        Part("spread of cameras that agree", "their scatter changes nothing", (ON_SHELF, PAIRS),
             changes={"kernels.reported_covariance.disagreement_m2": instead.only_apart}),
        Part("second place of a limb", "the place that is reported is the only one", (WRIST,),
             changes={"kernels.reported_covariance.add_other_places": instead.nothing}),
        Part("calibration part", "what cameras may be turned by is not stated",
             (PAIRS, ("a camera turned", "log-likelihood")),
             changes={"kernels.reported_covariance.sandwich3": instead.zeros}),
        Part("limbs that do not fit widen", "a limb that is far off counts like any other",
             (WRIST, PAIRS), changes={"kernels.lengths.LIMB_GATE": ALWAYS}),
        Part("growth while fewer than two cameras see a joint", "the bound of its error stays",
             (WRIST, (TWO, "log-likelihood")),
             changes={"kernels.reported_covariance.UNSEEN_DRIFT_MPS": 0.0}),
    ),
    "camera errors": (
        Part("camera errors learnt", "cameras are as calibrated, clocks are right",
             (TURNED, LATE, IN_TURN, ("a camera turned", "fault named")),
             changes={"tracker.Tracker._learn_cameras": instead.nothing}),
        Part("turns learnt", "only delays of clocks are learnt", (TURNED, PAIRS),
             changes={"kernels.camera_corrections.prior_of": instead.prior_of_delays}),
        Part("delays learnt", "only turns are learnt", (LATE,),
             changes={"kernels.camera_corrections.prior_of": instead.prior_of_turns}),
        Part("place of a joint eliminated", "residuals are those of the curve, which errors bend",
             (TURNED, LATE), changes={"kernels.camera_error_kernels.invert3": instead.no_inverse}),
        Part("one pushed camera is likelier", "a larger error does not widen its camera's prior",
             (TURNED, LATE), changes={"kernels.camera_corrections.prior_of": instead.same_prior}),
        Part("small camera errors are not applied", "whatever is found is applied",
             (WALKING, CROSSING, ERROR),
             changes={"kernels.camera_corrections.apply_sure": instead.apply_all}),
        Part("scale of a rig's errors", "any rig fits as well as usual", (PAIRS, LIKELIHOOD),
             changes={"kernels.camera_corrections.PRIOR_WEIGHT": ALWAYS}),
        Part("residuals after 0.15 s", "they are taken at once", (IN_TURN, TURNED),
             changes={"kernels.camera_error_kernels.CAMERA_LAG_S": 0.0}),
        Part("camera errors forgotten", "what was learnt once counts for ever",
             (("a camera turned at 8 s", "error"), ("a camera turned at 8 s", "log-likelihood")),
             changes={"kernels.camera_error_kernels.CAMERA_ERROR_S": ALWAYS}),
    ),
    "coming and going": (
        Part("anatomy of newcomers", "rays that meet are enough", (("a crowd", "ghosts"),),
             model=instead.no_bones),
        Part("other cameras join a birth", "a track begins with two cameras", (PCP_5,),
             changes={"birth._absorb": instead.nothing}),
        Part("confirmation", "every track is confirmed at once", (PHANTOMS,),
             {"confirm_s": NEVER}),
        Part("three cameras confirm at once", "they too must agree for `confirm_s`", (PCP_5,),
             changes={"kernels.presence.SURE_CAMERAS": ALWAYS}),
        Part("two cameras beyond doubt confirm at once", "they too must agree for `confirm_s`",
             (PCP_2,), changes={"birth.SURE_BIRTH_SCORE": ALWAYS}),
        Part("cameras that look and see nobody",
             "they do not delay the confirmation of a new track",
             (PHANTOMS, ("5 images a second", "ghosts"), ("a crowd", "missed")),
             changes={"lifecycle.missing_cameras": instead.nobody_missing}),
        Part("trial beside a confirmed track", "a second body is confirmed like any other",
             (AT_5, ("5 images a second", "ghosts"), ("on the floor", "ghosts")),
             changes={"lifecycle.ON_TRIAL": 0}),
        Part("patience by the number of views", "every track waits for `death_s`",
             (LEAVERS, GONE), changes={"kernels.presence.patience": instead.all_}),
        Part("people about to leave", "nobody is taken to leave", (LEAVERS, GONE),
             changes={"kernels.visibility_kernels.WALKS_MPS": ALWAYS}),
        Part("young tracks are given up sooner", "they wait as long as others", (PHANTOMS,),
             changes={"kernels.presence.survive_all": instead.survive_as_old}),
        Part("expected visibility", "two cameras should find everybody, wherever they look",
             (LEAVERS,), changes={"lifecycle.expected_cameras": instead.two_cameras}),
        Part("occlusion by other people", "a camera should find hidden people, too",
             (("a crowd", "missed"),),
             changes={"kernels.visibility_kernels.hidden_share": instead.none}),
        Part("end of tracks that one of many cameras supports", "it keeps them alive",
             (("a crowd", "ghosts"),), {"single_view_death_s": ALWAYS}),
        Part("tracks of one camera triangulated again", "the first distance stays",
             (("close together", "error"),),
             changes={"kernels.updating.trusted_two_view_s": instead.all_trusted}),
        Part("end of redundant tracks", "a track that others explain stays",
             (("Shelf, 2 cameras", "switches"), AT_5, ("a crowd", "ghosts")),
             changes={"kernels.presence.REDUNDANT_CHECKS": ALWAYS}),
        Part("a clearly better fit keeps its track", "any other fit makes a track redundant",
             (("Shelf, 2 cameras", "switches"), AT_5, ("close together", "missed")),
             changes={"kernels.pair_checks.FITS_BETTER_M": ALWAYS}),
        Part("re-identification", "nobody gets an old identity back",
             (("coming and going", "switches"), AT_5), {"reidentify_s": NEVER}),
        Part("duplicate suppression", "two tracks of one person both stay",
             (("a crowd", "ghosts"), ("5 images a second", "ghosts")), {"duplicate_m": NEVER}),
        Part("support of now", "a camera that no longer shows a joint supports it for 0.12 s more",
             (("coming and going", "support too high"),),
             changes={"kernels.snapshot_kernels.count_supporting": instead.count_looking_back}),
        Part("support of the reported time", "with a lag, the support is that of the newest image",
             (("coming and going, 0.2 s lag", "support too high"),),
             changes={"support_history.SupportHistory.at_its_time": instead.as_it_is}),
    ),
    "few images per second": (
        Part("gate grows while unseen", "it is that of 25 images per second", (AT_8, AT_5),
             changes={"kernels.mixture.LEEWAY_MPS": 0.0}),
        Part("look-back by camera", "support and waiting detections look back 0.1 s for all",
             (AT_8, AT_5, ("5 images a second", "missed")), changes={"lifecycle.LOOK_BACK": 0.0}),
        Part("unmatched tracks take newcomers", "a newcomer beside a living track is a new person",
             (AT_8, AT_5), changes={"tracker.Tracker._moved_on": instead.nothing}),
        Part("velocity of who was found again", "a track that moved on begins at rest",
             (AT_8, AT_5),
             changes={"reidentification.LostTrack.velocity_to": instead.at_rest}),
        Part("rays of different times may miss", "as far as those of one time", (AT_8, AT_5),
             changes={"tuning.PAIR_MPS": 0.0}),
        Part("only cameras that have looked since count", "all that should see the person do",
             (AT_5, ("5 images a second", "missed")),
             changes={"lifecycle.those_who_looked": instead.all_expected}),
    ),
    "people of one camera": (
        Part("tracks of one camera", "people exist once two cameras see them",
             (ALONE, ("one camera, new", "lost")), changes={"single_views.MOST_SINGLE_VIEWS": 0}),
        Part("distance filter of confirmed people", "body and ground hold them, as weak joints",
             (KNOWN, KNOWN_DEPTH),
             changes={"kernels.updating.hold_distances": instead.hold_singles}),
        Part("lasting error of the size", "people are of the size that is assumed",
             (NEW, KNOWN),
             changes={"tuning.SIZE_SPREAD": NEVER, "tuning.KNOWN_SIZE_SPREAD": NEVER}),
        Part("distance by the ground", "only the size tells the distance",
             (NEW_DEPTH, NEW, KNOWN), changes={"kernels.body_size.above_ankle_m": instead.none}),
        Part("distance by the size", "only the ground tells the distance", (NEW_DEPTH, NEW, KNOWN),
             changes={"kernels.distance_filter.SIZE_NOISE": ALWAYS}),
        Part("errors of gait last for a step", "each image measures anew", (NEW, KNOWN),
             changes={"kernels.distance_filter.WALK_NOISE_S": NEVER}),
        Part("foreshortened limbs left out", "all limbs tell the size", (NEW_DEPTH, KNOWN_DEPTH),
             changes={"kernels.body_size.FORESHORTENED": ALWAYS}),
        Part("only upright people are measured", "the size of all tells the distance",
             (("one camera, sitting or lying", "missed"),
              ("one camera, sitting or lying", "log-likelihood")),
             changes={"tuning.UPRIGHT": 0.0, "tuning.SAT_DOWN": 0.0}),
        Part("error of the distance stated along the rays", "it is not stated", (NEW, KNOWN),
             changes={"kernels.snapshot_kernels.widen_along_rays": instead.nothing}),
        Part("ground known from earlier people", "the floor is assumed for everybody new",
             (("coming and going", "missed, provisional people counted"),),
             changes={"ground_prior._known_m": instead.no_levels}),
        Part("more support where other cameras see nobody", "one camera is enough everywhere",
             (PROVISIONAL, ("phantoms of two cameras", "ghosts, provisional people counted")),
             changes={"single_views.SingleViews._expected": instead.one_each}),
        Part("weak detections count for less", "any detection is a full one",
             (PROVISIONAL, ("phantoms of two cameras", "ghosts, provisional people counted")),
             changes={"single_views._worth_s": instead.any_detection_s}),
        Part("explained detections begin nobody", "each detection that is left begins a track",
             (PROVISIONAL, ("phantoms of two cameras", "ghosts, provisional people counted")),
             changes={"single_views.SingleViews._explained": instead.none_explained}),
    ),
    "a lag, which the full model does without": (
        Part("0.08 s lag", "people as they were 0.08 s ago", (PCP_2,), lag_s=0.08),
        Part("0.2 s lag", "people as they were 0.2 s ago", (PCP_2,), lag_s=0.2),
    ),
}  # fmt: skip
"""All parts, in groups."""
