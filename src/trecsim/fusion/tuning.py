"""Constants that shape how the fusion behaves and are no settings, in one table.

Nobody should need to change them: they follow from how people move, how key-point estimators err,
or from tests on synthetic scenes. What a site may want to change is in `trecsim.fusion.settings`;
what is known of bodies, joint by joint, in `trecsim.fusion.body`. Log likelihood ratios are natural
logarithms. Compiled kernels keep the values they were compiled with.
"""

from typing import Final

# ---------------------------------------------------------------------------------- association

# A detection is compared with a track only if their joints are closer than this on average, at the
# track's distance [m].
GATE_M: Final = 0.8
# Weight of an image that follows its camera's last one at once, next to an independent one.
LEAST_INDEPENDENCE: Final = 0.05

# --------------------------------------------------------------------------------------- birth

# Time for which an unassigned detection waits for one of another camera to pair with [s].
UNASSIGNED_S: Final = 0.1
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
# Time for which most cameras read a track with left and right exchanged, until it is mirrored [s]:
# longer than a detector errs at a stretch.
MIRROR_S: Final = 0.2
# Two tracks closer than `duplicate_m` are one after this time [s].
DUPLICATE_S: Final = 0.25

# ------------------------------------------------------------------------------ re-identification

# A new track gets a dead one's identity within this distance of where the person may be by now, an
# arm's length, plus half of a walking speed times the time that has passed [m, m/s].
REIDENTIFY_M: Final = 0.5
REIDENTIFY_MPS: Final = 0.6
# Longest extrapolation at the last velocity: after a step, people turn or stop [s].
EXTRAPOLATE_S: Final = 0.5

# -------------------------------------------------------------------------------------- snapshots

# Times closer than this are the same; differences of times are rarely exact [s].
SAME_S: Final = 1e-6
