"""Every number of the calibration from people, with its reason.

None is taken from the simulator. Sizes of errors are what pose estimators do on real people:
key points are off by 1 to 2 % of the body height, and for seconds in the same direction.
"""

import numpy as np

LEAST_SCORE = 0.3
"""A key point of which the estimator is less sure is not used."""

# Tracklets, per camera.
LONGEST_GAP_S = 0.5
"""A tracklet ends when its person is missing for longer [s]."""
LINK_GATE = 0.12
"""Largest median step of the joints from one image to the next, over the body's size."""
LINK_GATE_PER_S = 0.5
"""What the gate grows by per second between the images."""
LINK_MARGIN = 2.0
"""A link is doubtful, and ends both tracklets, unless the second best is so many times worse."""
LINK_SURE = 0.06
"""And so much worse at least, over the body's size."""
SHORTEST_TRACKLET_S = 0.5
MOST_OPEN = 64
"""Most people in an image that are linked."""

# Body, as shares of the stature (Winter, Biomechanics and Motor Control of Human Movement).
ANKLE, KNEE, HIP, SHOULDER, EAR, EYE, NOSE = 0.039, 0.285, 0.530, 0.818, 0.93, 0.936, 0.915
HEIGHT_OF_JOINT = np.array([
    NOSE, EYE, EYE, EAR, EAR, SHOULDER, SHOULDER, 0.63, 0.63, 0.485, 0.485, HIP, HIP, KNEE, KNEE,
    ANKLE, ANKLE,
])  # fmt: skip
"""Height of each COCO joint of somebody who stands, over the stature."""
WALKING = 0.985
"""A walking body is so much shorter: knees bend."""
STATURE_M = 1.70
STATURE_SD_M = 0.08
"""Mean stature of people nobody measured, and its standard deviation [m]."""

# Floor tracks.
TICK_S = 0.1
"""Spacing of the floor tracks and of the offsets tried [s]."""
SMOOTH_TICKS = 4
"""Floor tracks are smoothed by a running median of so many ticks to each side."""
LEAST_UPRIGHT = 12
"""Fewest upright sights that give a camera's vertical and height."""

# Pairs of cameras.
LONGEST_OFFSET_S = 30.0
"""Clocks may differ by so much [s]."""
SHORTEST_OVERLAP_S = 2.0
EXTENT_M = 0.4
"""A track that spreads less tells no offset [m]."""
FLOOR_ERROR_M = 0.2
"""Usual error of a floor position before the adjustment [m]."""
FLOOR_GATE_M = 0.7
"""Two sights further apart on the floor are not the same person [m]."""
MOST_HYPOTHESES = 60
"""So many motions of a pair of cameras are tested on all tracks."""
LEAST_MATCHED_S = 2.0
"""Cameras whose tracks agree for less time are not related [s]."""

# Pairs of cameras related by bodies, where tracks on the floor are too short.
BODY_OVERLAP_S = 0.6
"""Least time that two tracklets must have in common to be compared [s]."""
BODY_LAGS_S = (0.0, -0.15, 0.15, -0.3, 0.3)
"""Lags that are tried [s]: a short recording is used only if the clocks nearly agree."""
BODY_FITS = 0.45
"""Least mean weight of the key points of two tracklets to be of one person."""
BODY_TURN_SD_DEG = 12.0
"""Largest standard deviation of a relation's rotation; still or distant bodies exceed it."""
BODY_TILT_RAD = 0.1
"""Standard deviation of the vertical that a body shows: people may lean [rad]."""

# Association.
CHAIN_FLOOR_M = 0.6
CHAIN_RAY_M = 0.15
"""Median distance on the floor, and of the joints' viewing rays, within which tracklets of two
cameras are the same person, before and after the first adjustment [m]."""
CHAIN_OVERLAP_S = 0.6
"""Tracklets with less time in common are not compared [s]."""

# Observations.
SAMPLE_S = 0.3
"""Spacing of the moments that are adjusted [s]. With 0.17 s offsets of clocks are nearer (one
walker: 2.0 -> 1.4 ms), but key points are off in the same way for longer than that: two cameras
turn from 0.08 to 0.11 degrees, and the covariance is too small."""
FEWEST_SAMPLES = 40
"""If there would be fewer moments, the spacing shrinks, down to `REFIT_SAMPLE_S`."""
MOST_SAMPLES = 700
"""Of more moments of people, the spacing grows; time is thinned, never the joints."""
WINDOW_S = 0.14
"""A key point is the line through the images nearer in time [s], the near ones counting more."""
STRAY = 0.06
"""An image further from the line is left out of it, over the body's size."""

# Adjustment.
KNOT_S = 3.0
"""The bias of a camera's key points is constant for so long [s]."""
BIAS_S = 6.0
"""Correlation time of the bias [s]."""
BIAS_M = np.array([0.035] * 5 + [0.024] * 2 + [0.02] * 2 + [0.024] * 2 + [0.03] * 2 + [0.026] * 4)
"""Standard deviation of the bias per joint and axis [m]: 1 to 2 % of the body height. The five of
the head are off together, so that each counts less."""
NOISE_M = np.array(
    [0.011] * 5 + [0.015] * 2 + [0.014] * 2 + [0.018] * 2 + [0.016] * 4 + [0.018] * 2
)
"""Standard deviation of what changes faster, per joint and axis [m]."""
LEAST_VARIANCE, MOST_VARIANCE = 0.2, 4.0
"""A recording may show variances so many times those of `BIAS_M` and `NOISE_M`."""
NOISE_PX = 1.0
"""Error of a key point that does not shrink with the person [px]."""
LEVEL_M = np.array([0.035] * 7 + [0.15] * 2 + [0.25] * 2 + [0.035] * 2 + [0.06] * 2 + [0.09] * 2)
"""By how much the height of a joint varies while its person walks [m]."""
ROBUST = 3.0
"""Residuals of more standard deviations count less and less (Geman and McClure)."""
LEAST_WEIGHT = 1e-4
"""A weight never falls below: a covariance of nothing is not a number."""
ANNEALING = (10.0, 5.0, 2.5, 1.5, 1.0)
"""Noise over its usual size, one stage after the other."""
STEPS = 6
"""Most steps in a stage."""
CONVERGED_RAD = 2e-6
"""A stage ends when no camera turns by more [rad]."""
DRIFT_PPM = 50.0
"""Usual drift of a clock of quartz [ppm]; a recording that shows more is believed."""
DRIFT_LOOSE = 5e-3
"""Standard deviation of the drift in the adjustment: a frame rate that is only nominal."""
OFFSET_LOOSE_S = 10.0

LENS_SD = (0.02, 0.01, 0.01)
"""Standard deviation of a focal length, as a share of it, and of a principal point, over it."""
LENS_EVIDENCE = 10.0
"""Twice the logarithm of a Bayes factor that Kass and Raftery (1995) call very strong evidence."""
LENS_NAMED, LENS_LEAST = 2.0, 0.008
"""A camera's intrinsics are named as off from so many standard deviations on, and so much."""

# A rig that is checked or repaired.
KNOCK_TURN_DEG, KNOCK_SHIFT_M = 2.0, 0.01
"""What a camera that was knocked turns and shifts by: mounts turn, they hardly move [deg, m]."""
LOOSER = 3.0
"""People are matched within so many times the usual distances: the rig may be wrong."""
REFIT_SAMPLE_S = 0.1
"""Spacing of the moments of short recordings [s]."""
REFIT_SAMPLES = 150
"""Most moments of a part of a recording."""
REFIT_CLOCK = (0.2, 5e-5)
"""Standard deviations of a clock's offset [s] and drift about those of the rig."""
AGREE_DEG = 0.2
"""Cameras agree when none shows the people further from where all of them together say [degrees].
With a right rig it is up to 0.14 in 1.7 s of three people, 0.12 in 5 s, and less later."""
STAY_TURN_DEG, STAY_SHIFT_M = 0.1, 0.003
"""By how much cameras that agree with each other may change in a repair."""
FAR_LAG_S = 5.0
"""Clocks may be wrong by so much when a rig is checked [s]."""
CLEAR_LAG_S = 0.15
"""A lag of floor tracks that is smaller is left to the adjustment [s]."""
WINDOW_CHECK_S = 5.0
"""A camera is judged by so much of the recording at a time [s]."""
MOST_WINDOWS = 60
"""A long recording is judged in so many parts."""
LATE_S = 0.02
"""A clock is off from so much on [s]."""
