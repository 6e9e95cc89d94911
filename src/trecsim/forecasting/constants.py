"""Constants of the floor forecast that are no fitted table: how people are sampled and filtered.

The constants of the filters were chosen on all scenes of ETH/UCY. Forecasts hardly depend on them:
halving or doubling one changes the mean error there by less than 2 %, but for `SLOWING_PER_S`,
which doubled makes it 6 % larger in true time. What was fitted is in
`trecsim.forecasting.spread_table`.
"""

from typing import Final

# A forecast looks at so many samples, so far apart: the published protocol's 3.2 s [s].
PAST: Final = 8
PAST_STEP_S: Final = 0.4
# Tables and calibration are for these horizons: as many steps, up to so long ahead [s].
STEPS: Final = 12
FULL_AHEAD_S: Final = 4.8
# Over a longer gap between two observations nothing is interpolated [s].
LONGEST_GAP_S: Final = 1.0

# Each filter assumes one of these accelerations and one of these measurement errors (standard
# deviations). Together they cover people from standing to starting to run, and floor points from
# an annotator's spline to a detector's noise; which fits is weighed for each person.
ACCELERATIONS_MPS2: Final = (0.05, 0.1, 0.2, 0.4, 0.8)
NOISES_M: Final = (0.0025, 0.005, 0.01, 0.02, 0.04, 0.08)
# Accelerations are forgotten at this time constant: a step, not a manoeuvre [s].
ACCELERATION_TIME_S: Final = 0.2
# People slow down: velocity decays at this rate [1/s]; 0.02 is 9 % in 4.8 s.
SLOWING_PER_S: Final = 0.02
# Standard deviation of an unseen person's velocity [m/s].
FIRST_SPEED_MPS: Final = 1.0
# Innovations say least about turns to come: the filters average as if measurement errors were
# larger by this factor.
EXTRA_NOISE: Final = 1.5
# Heavy tails make likelihoods too confident: the share of the log likelihood that counts, of the
# person's own past and of each other person's in view, whose points have errors of the same kind.
OWN_TRUST: Final = 0.3
OTHERS_TRUST: Final = 0.1

# ----------------------------------------------------------------------------------- calibration

# Regions are stated, and calibrated while running, at these levels.
LEVELS: Final = (0.5, 0.8, 0.9, 0.95)
# The whole path stays within its region at this one.
PATH_LEVEL: Final = 0.9
# People are told apart by their speed: the spread of those who stand is another than of those who
# walk. The last class is people seen only once, whose velocity is unknown [m/s].
SPEED_EDGES_MPS: Final = (0.15, 0.6, 1.1)
CLASSES: Final = 5
# The logarithm of a radius moves by so much with the first truths, and by so much in the long run:
# fast where a site differs from the table, then slow enough not to follow chance.
FIRST_STEP: Final = 0.3
LAST_STEP: Final = 0.05
# So many truths halve the step between the two.
HALVING_TRUTHS: Final = 10.0
# A forecast is compared with what happened this often; in between, errors are nearly the same [s].
FEEDBACK_S: Final = 0.4
# No standard deviation is stated below this [m].
SMALLEST_SIGMA_M: Final = 0.002
# People of one moment are no independent truths: together they move a radius by so much at most.
MOST_STEP: Final = 2.0
# No radius shrinks below this, however exactly people stand still, in units of the scale.
SMALLEST_RADIUS: Final = 1e-3
# Nobody's path is forecast for longer: nothing here was compared with the truth there [s].
LONGEST_AHEAD_S: Final = 10.0

# -------------------------------------------------------------------------------------- poses

# Poses are forecast for so long unless other horizons are asked for [s].
POSE_AHEAD_S: Final = 1.0
POSE_STEP_S: Final = 0.1
# The body's velocity is the slope over the newest such time [s].
SLOPE_S: Final = 0.18
# How long the body keeps its velocity along the floor, and up or down [s]: a step or jump soon
# ends. Chosen on every other clip of recorded motion, see `benchmarks/forecast.py`.
KEEPS_S: Final = 2.0
KEEPS_UP_S: Final = 0.15
# From so far ahead on the body follows the floor forecast alone, before in part [s].
FLOOR_ALONE_S: Final = 1.0
