"""Constants that shape how the fusion behaves and are no settings, in one table.

Nobody should need to change them: they follow from how people move, how key-point estimators err,
or from tests on synthetic scenes. What a site may want to change is in `trecsim.fusion.settings`;
what is known of bodies, joint by joint, in `trecsim.fusion.body`. Log likelihood ratios are natural
logarithms. Compiled kernels keep the values they were compiled with: a changed table compiles them
anew. Only bounds that guard against rounding, such as ``1e-12``, stand in the kernels themselves.
"""

from typing import Final

# ------------------------------------------------------------------------------------ key points

# The noise of a key point grows as this power of its falling score, and by this factor at most.
SCORE_POWER: Final = 1.7
LARGEST_SIGMA_SCALE: Final = 6.0
# A network that looks coarsely places key points coarsely. Up to a pixel of its input of this share
# of a person's size it makes no difference; the variance beyond grows with the square. Differences
# to mirrored looks at 576 px, both recordings of two actors, 12 joints: median 6.7 px at 512
# (share 0.0058), 8.6 at 384, 14.8 at 256.
FINE_PIXEL_SHARE: Final = 0.0058
COARSE_VARIANCE: Final = 0.6
# No image is so large that a key point of it lies here [px].
FAR_PX: Final = 1e5
# Two detections of an image are duplicates if all their common key points lie this close, as a
# share of the detection's size; and the fewest common ones, as one or two may coincide by chance.
DUPLICATE_SHARE: Final = 0.03
DUPLICATE_JOINTS: Final = 3

# ------------------------------------------------------------------------------- measurement model

# A joint nearer than this to a camera's plane is not compared with its image [m].
NEAR_M: Final = 0.05
# Trajectories are stiff and people turn at once: whether a key point belongs to a joint is judged
# as if the prediction's variance were so many times larger, up to so much more in each direction
# [m].
LEEWAY: Final = 12.0
LEEWAY_M: Final = 0.06
# Both grow with the time since a track was seen, as its velocity may have changed by so much: at 8
# images per second somebody who falls or stops is that much further away [m/s]. So many times the
# usual distance at most.
LEEWAY_MPS: Final = 1.0
MOST_SLACK: Final = 5.0

# ------------------------------------------------------------------------------- fit of the joints

# EM steps at most, and how far a joint moves in the last one at most, squared [m^2].
EM_STEPS: Final = 3
STILL_M2: Final = 0.0005**2
# Images this close in time enter the trajectory at their common mean time [knots].
TOGETHER: Final = 0.5
# Covariance inflation. The normalised innovation squared of all joints of a body, over its expected
# value, shows a sharp turn from `NIS_GATE` on. In steady motion it is near `USUAL_NIS` or below, as
# a detector's errors persist and the process noise allows for the fastest joints. The inflation is
# the ratio over its usual value, at most `LARGEST_INFLATION`.
NIS_GATE: Final = 2.5
USUAL_NIS: Final = 1.25
LARGEST_INFLATION: Final = 50.0
# What all key points of a body in one camera have been off by for this time is no turn [s]; after a
# longer one without an image, what it was off by says nothing [s].
VIEW_OFFSET_S: Final = 0.5
LONGEST_OFFSET_S: Final = 5.0

# ----------------------------------------------------------------------------------------- motion

# Weight of a torso joint that no camera supports in the mean velocity of the body; supported joints
# have weight 1.
UNSEEN_WEIGHT: Final = 0.05
# Where fewer than two cameras support the body, depth is unobserved: the velocity of the body is
# multiplied by this for each knot; where none does, by the other: people who are not seen have
# turned, stopped or left.
KEPT: Final = 0.8
KEPT_UNSEEN: Final = 0.6

# -------------------------------------------------------------------------------- camera errors

# Standard deviations, before anything is known, of a camera's turn about each axis [rad] and of its
# clock [s]: what calibrations that were made with care and clocks of a network leave, after cameras
# have been touched and warmed up. What is left of the turn
# of a camera that has been watched for long [rad].
TURN_SIGMA_RAD: Final = 0.008
CLOCK_SIGMA_S: Final = 0.005
LEAST_TURN_RAD: Final = 0.001
# Where cameras disagree, those that are turned, or late, by more than this are allowed more: that
# one camera was pushed is likelier than that all the others were [rad, s]. Smaller turns and delays
# are no different from lasting errors of key points: they are not applied, nor are those that are
# not as many standard deviations large.
PUSHED_RAD: Final = 0.002
PUSHED_S: Final = 0.005
SURE: Final = 1.5
# Residuals count anew after this time, as those of one camera last [s]. They are taken of images
# within such a block [s], so long after it [s], of so many people in a step; what was learnt is
# forgotten over this time, as cameras are moved [s].
CAMERA_MEASURE_S: Final = 2.0
CAMERA_BLOCK_S: Final = 0.1
CAMERA_LAG_S: Final = 0.15
MOST_BLOCKS: Final = 8
CAMERA_ERROR_S: Final = 20.0
# Projections are corrected anew once in this time for so long, then once in so long [s].
CAMERA_CHECK_S: Final = 0.1
CAMERA_SETTLE_S: Final = 10.0
CAMERA_RENEW_S: Final = 0.5
# A turn that a camera's whole image tells is as exact as the errors of key points that last [rad].
PUSH_SIGMA_RAD: Final = 0.003
# Weight of the usual variance of turns against that of one camera's angle: the residuals of two
# cameras that agree outweigh it. Cameras whose image directions a point in space takes up.
PRIOR_WEIGHT: Final = 1.0
EYES_OF_A_POINT: Final = 1.5

# --------------------------------------------------------------------------------- limbs and ground

# A length of a limb is learnt from measurements of this variance, of which the next is independent
# after this time [m^2, s]; its own variance stays above this, so that it can be learnt anew [m^2].
LENGTH_MEASURE_M2: Final = 0.02**2
LENGTH_MEASURE_S: Final = 0.5
SUREST_LENGTH_M2: Final = 0.005**2
# Variance of a limb's equation besides what is known of its length [m^2].
TIE_M2: Final = 0.01**2
# A limb whose length is off by more standard deviations has no effect: one end is elsewhere. How
# often each limb has its effect when joints are adjusted to the lengths.
LIMB_GATE: Final = 3.0
LIMB_SWEEPS: Final = 4
# A joint less well known than this, summed over the directions, needs its body even if two cameras
# see it: they may stand side by side [m^2].
WEAK_M2: Final = 0.2**2
# Gauss-Newton steps for the joints that need their body; variance of how far one step moves a joint
# [m^2]: a limb across the line of sight says nearly nothing about depth, and its linearised
# equation holds near the joint only.
BODY_STEPS: Final = 3
REACH_M2: Final = 0.3**2
# What the body says of a joint is new after this time, as a length that is off stays so [s].
BODY_S: Final = 1.3
# The height of the ground, as the lengths of limbs [m^2, s]; how far it rises or falls under people
# who walk on, and how far it may while two cameras see them elsewhere, on stairs [m^2/s].
GROUND_MEASURE_M2: Final = 0.03**2
GROUND_MEASURE_S: Final = 0.5
SLOPE_M2PS: Final = 0.02**2
STAIRS_M2PS: Final = 0.15**2
# The end of a limb that one camera alone sees may be before or behind the other end. The log
# likelihood ratio of the two places is averaged over this time [s]; the joint is moved when it is
# above this (odds of 3 to 1, since the present place is likelier a priori). Places that are closer
# together count as one [m].
PLACE_S: Final = 0.1
PLACE_SURE: Final = 1.0
PLACES_APART_M: Final = 0.2
# The end of a limb that no camera has seen for so long is drawn to where it usually is [s].
UNSEEN_LIMB_S: Final = 0.2
# A lowest joint that is off by more standard deviations does not rest: somebody jumps.
GROUND_GATE: Final = 3.0

# ----------------------------------------------------------------------------- reported covariance

# Standard deviation of a joint in a direction that no camera observes [m], and how fast it grows
# with the time for which no two cameras have seen the joint [m/s], up to so long [s].
UNSEEN_SIGMA_M: Final = 0.1
UNSEEN_DRIFT_MPS: Final = 0.1
UNSEEN_DRIFT_S: Final = 5.0
# Time after which nothing is left of a second camera's say about which of the two places on the ray
# of one camera a limb's end is in [s].
TWO_PLACES_S: Final = 0.5
# A key point that the newest image of its camera no longer shows was a weak one: the inverse of its
# noise variance, relative to that of a good one.
FADED_QUALITY: Final = 0.2
# A bias wanders by about one standard deviation in 0.2 s [1/s]. In a direction that no camera
# observes, the error of the velocity that this makes is at most so large [m/s].
BIAS_WANDER_PER_S: Final = 5.0
UNSEEN_SIGMA_MPS: Final = 0.2

# ---------------------------------------------------------------------------------- association

# A detection is compared with a track only if their joints are closer than this on average, at the
# track's distance [m].
GATE_M: Final = 0.8
# The errors of a detection's key points are correlated: 17 of them are worth about a third.
TEMPER: Final = 3.0
# Weight of an image that follows its camera's last one at once, next to an independent one.
LEAST_INDEPENDENCE: Final = 0.05

# --------------------------------------------------------------------------------------- birth

# Time for which an unassigned detection waits for one of another camera to pair with, at least [s];
# see `LOOK_BACK`.
UNASSIGNED_S: Final = 0.1
# Standard deviation of the velocity at which people move between the images of a pair, per axis
# [m/s]: then two rays to the same joint miss each other.
PAIR_MPS: Final = 1.0
# Of more unassigned detections only the best are paired, as the work grows with the square of their
# number: a crowd of 20 in view of three cameras.
MOST_UNASSIGNED: Final = 60
# Two detections begin a track from this log likelihood ratio to chance on: 1 in 20,000 pairs of
# different people would reach it if key points erred independently.
BIRTH_SCORE: Final = 10.0
# A pair that reaches this, and that has no other possible partner, is reported at once.
SURE_BIRTH_SCORE: Final = 25.0
# Detections of further cameras join a birth from this log ratio to clutter on: a low threshold, as
# two cameras have placed the person.
JOIN_SCORE: Final = 3.0
# Standard deviation of the place that two cameras give, when further cameras are compared [m].
CANDIDATE_SIGMA_M: Final = 0.08
# Two rays show the same joint if they pass each other within this distance [m]; a birth needs so
# many joints.
MEETING_GAP_M: Final = 0.25
FEWEST_JOINTS: Final = 4
# A pair is scored only if so many joints meet; any two strangers have three by chance.
PAIR_JOINTS: Final = 4
# Rays whose angle has a smaller squared sine (below 2 degrees) do not meet anywhere; nobody is met
# nearer to a camera than this [m]; rays that pass further from each other than so many standard
# deviations show different points.
PARALLEL: Final = 1e-3
TOO_CLOSE_M: Final = 0.2
RAY_GATE: Final = 3.0
# Log likelihood ratio of a limb's length: a body's spread, of about a third, against any length at
# all; whatever the length, it weighs no more than an outlier.
LIMB_BEST: Final = 1.3
LIMB_CURVE: Final = 4.0
LIMB_WORST: Final = -4.0

# --------------------------------------------------------------------- first state of a new track

# Standard deviation of a joint before its own key points are fitted: one that two cameras place,
# and one that is placed from its neighbours, a limb's length away [m].
FIRST_SIGMA_M: Final = 0.4
GUESSED_SIGMA_M: Final = 0.6
# Standard deviation of the first velocity, per axis: people stand or walk when they appear [m/s].
FIRST_SPEED_MPS: Final = 1.5
# Standard deviation of the ground's height where people appear, about the world's z = 0 [m].
FIRST_LEVEL_SIGMA_M: Final = 0.3
# A shorter trunk does not tell which way is down [m].
SHORTEST_TRUNK_M: Final = 0.2
# Spread of limb lengths over people, as a share of the usual length.
LENGTH_SPREAD: Final = 0.15

# ------------------------------------------------------------------------- people of one camera

# Relative spread of the distance that the size of a body tells: of stature over adults, 6 %, with
# other proportions of limbs and a lasting posture. Its noise, of gait, which lasts as long as a
# step [s]; that of the height of ankles; and how far one ankle, or the mean of two, is before or
# behind the body [m].
SIZE_SPREAD: Final = 0.08
SIZE_NOISE: Final = 0.04
WALK_NOISE_S: Final = 0.25
SOLE_NOISE_M: Final = 0.04
STEP_NOISE_M: Final = (0.15, 0.03)
# The same of somebody whose limbs two cameras have measured: a lasting posture. How far off two
# cameras place somebody at least [m], and a velocity along the rays of one of them [m/s].
KNOWN_SIZE_SPREAD: Final = 0.03
PLACE_SIGMA_M: Final = 0.03
# Who stands or walks: the height of the limbs from shoulders to ankles is at least this share of
# their lengths, and then no less than the second one (who sits has 0.7). Nothing measures the
# distance of others, whose relative variance grows by so much [1/s].
UPRIGHT: Final = 0.85
SAT_DOWN: Final = 0.72
RANGE_DRIFT2_PER_S: Final = 0.02**2
KNOWN_RATE_MPS: Final = 0.3
# A limb that says more than this factor of the nearest distance is turned towards the camera or
# away from it. Nobody begins whose distance is less well known than this share of it.
FORESHORTENED: Final = 1.25
MOST_RANGE_SIGMA: Final = 0.2
# How people move towards a camera or away from it: standard deviation of the first speed [m/s],
# density of their acceleration [m^2/s^3], and for how long they keep a speed unseen [s]. What is
# off by more standard deviations is no distance: a foot in the air, or somebody who lies.
RANGE_SPEED_MPS: Final = 1.2
RANGE_ACCEL_M2PS3: Final = 0.5
RANGE_MEMORY_S: Final = 2.0
RANGE_GATE: Final = 3.0
# What is assumed of the ground before anybody has been seen counts for so much of a person; the
# ground under so many people is remembered, where it is known to 8 cm.
UNKNOWN_LEVEL_WEIGHT: Final = 0.5
LEVELS_REMEMBERED: Final = 50
KNOWN_LEVEL_M2: Final = 0.08**2
# The most tracks of one camera at a time, as each costs as much as several others. Where false
# positives or a crowd that comes in at once fill them, further people wait for a second camera.
MOST_SINGLE_VIEWS: Final = 30
# A track of one camera is reported when the images that support it amount to this time: each counts
# for the time since its camera's last one, up to `LONGEST_STEP_S`, times the share of good key
# points in the detection. Good detections need 0.1 s, those as weak as false positives 0.4 s; each
# further camera that should see the person, and does not, makes that so many times longer.
SINGLE_VIEW_S: Final = 0.1
MISSED_PATIENCE: Final = 1.5
LONGEST_STEP_S: Final = 0.09
# Such a track dies when no camera has supported it for as long as it had been supported, within
# these limits; the upper one is `death_s` [s].
SINGLE_VIEW_PATIENCE_S: Final = 0.25
# A detection begins nobody if it lies this close, at the track's distance, to a track that no
# detection of that image supports (its own, badly read), or to one that has another (a duplicate).
VACANT_M: Final = 0.5
OCCUPIED_M: Final = 0.12

# ----------------------------------------------------------------------- checks of existing tracks

# Time between two checks whether a track mixes two people or is redundant [s]: a detector's errors
# persist, so that more checks would not be independent.
CHECK_S: Final = 0.1
# The pair of detections of a track is given up from this evidence for a swap on; the most that one
# check adds; and from which log likelihood ratio on, which half of all right pairs reach, a pair is
# only tested as the partner of others.
SWAP_EVIDENCE: Final = 10.0
MOST_SWAP_EVIDENCE: Final = 20.0
CLEAR_PAIR: Final = 25.0
# Number of checks in which other tracks explain all detections of a track, until it is deleted.
# People who cross are in line for one camera as long, but not for two at a time.
REDUNDANT_CHECKS: Final = 3.0
# A detection whose key points lie this near on average shows the person, at its distance [m], but
# another one rather if it fits that one better by so much.
FITS_M: Final = 0.12
FITS_BETTER_M: Final = 0.05
# Time for which most cameras read a track with left and right exchanged, until it is mirrored [s]:
# longer than a detector errs at a stretch.
MIRROR_S: Final = 0.2
# Two tracks closer than `duplicate_m` are one after this time [s].
DUPLICATE_S: Final = 0.25

# ---------------------------------------------------------------- support, confirmation and death

# A camera supports a joint or person "now" if it did within this time [s], or within so many of its
# own usual intervals if that is longer, but not longer than this [s].
SUPPORT_S: Final = 0.12
LOOK_BACK: Final = 1.5
LONGEST_SUPPORT_S: Final = 0.5
# A key point supports its joint from this responsibility on; so many of them support a person.
INLIER: Final = 0.5
FEWEST_INLIERS: Final = 3
# So many cameras that support a track at a time confirm it at once.
SURE_CAMERAS: Final = 3
# A track dies after this share of `death_s` if no camera has the person in view, or if the person
# was leaving. Of cameras that should see the person, `USUAL_CAMERAS` may miss it for `death_s`, and
# more of them for as many images in all: that all of them miss a real person is unlikely.
LEAST_PATIENCE: Final = 0.5
USUAL_CAMERAS: Final = 2.0
# One of so many cameras does not keep a track alive for long.
CROWDED: Final = 3
# Whoever walks is about to leave if no camera that should see the person now has the place in view
# where the person is after this time [s]; or if at most half of the cameras have the person in
# view, no more will then, and the person walks at least so fast [m/s]: doors are where few cameras
# look.
STEP_S: Final = 0.5
WALKS_MPS: Final = 0.3
# Log likelihood ratio of a new track to a phantom, for each camera that shows a person there, and
# against it for each that looks and shows nobody: detectors find 85 % of people, and 5 % of places
# are hidden from a camera or have a false detection. A pair beyond doubt is worth this many times
# `confirm_s` of support.
LOOK_SEES: Final = 2.83
LOOK_MISSES: Final = 1.85
SURE_BIRTH_WORTH: Final = 1.5
# Two tracks are beside each other within this mean distance of their torsos [m]: then a camera's
# detection of the one may show the other, as of people in a group, or of somebody who lies and
# whose pose is read badly.
BESIDE_M: Final = 1.0
# A provisional track needs two cameras again within this time [s].
TENTATIVE_S: Final = 0.25
# A point nearer than this to a camera's plane is not expected in the image [m].
AHEAD_M: Final = 0.1
# A camera should detect a person of whose torso at least this share is in its image: people who
# stand half outside are found by detectors as often as not.
IN_VIEW: Final = 0.5
# A person of whom others hide at least this share of the joints is not expected to be found. Who
# hides somebody stands before that person by at least the thickness of a body [m], and no further
# beside the line of sight than two people reach, as far as their joints lie from their torsos [m].
HIDDEN_SHARE: Final = 0.5
BEFORE_M: Final = 0.2
ASIDE_M: Final = 2.0

# ------------------------------------------------------------------------------ re-identification

# A new track gets a dead one's identity within this distance of where the person may be by now, an
# arm's length, plus half of a walking speed times the time that has passed [m, m/s].
REIDENTIFY_M: Final = 0.5
REIDENTIFY_MPS: Final = 0.6
# The time for which one camera alone had seen the person counts, too, up to this [s]: the distance
# from a camera is only roughly known.
ALONE_S: Final = 1.0
# A new track replaces a living one without a detection in the frame set within this distance of
# where that person may be: the error of a place, plus the speed of a trunk that falls times the
# time since the track was last seen [m, m/s]. The velocity of a younger track is hardly known [s]:
# its person may run [m/s].
UNSEEN_M: Final = 0.2
UNSEEN_MPS: Final = 3.0
YOUNG_S: Final = 0.2
YOUNG_MPS: Final = 6.0
# A living track that another camera still shows is replaced, too, if so many cameras showed it
# lately and show the new one now: along the ray of a camera the gate is wide. Lately is so many
# times as long ago as a camera's support counts, as an image may be lost and a detection missed.
TORN_VIEWS: Final = 2
TORN_LOOK_BACK: Final = 2.0
# Longest extrapolation at the last velocity: after a step, people turn or stop [s].
EXTRAPOLATE_S: Final = 0.5

# -------------------------------------------------------------------------------------- snapshots

# Times closer than this are the same; differences of times are rarely exact [s].
SAME_S: Final = 1e-6
