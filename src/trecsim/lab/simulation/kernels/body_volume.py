"""How thick the parts of a body are that block the view; nothing of the tracker is used here.

Trunk, thighs and shanks are cylinders between their joints with the volume of the body part: its
share of the body mass over its density (Winter, Biomechanics and Motor Control of Human Movement,
table 4.1, after Dempster). The head has the mean of half its breadth and half its length (Gordon et
al., 1988 Anthropometric Survey of U.S. Army Personnel, mean of men and women).
"""

from math import pi, sqrt

import numpy as np

MASS_KG, STATURE_M = 75.0, 1.75  # an adult of ordinary build
COVER_M = 0.015  # clothes and hair
HEAD_BREADTH_M, HEAD_LENGTH_M = (0.152 + 0.144) / 2, (0.197 + 0.187) / 2


def _cylinder_m(mass_share: float, density_kgpm3: float, length_share: float) -> float:
    volume_m3 = mass_share * MASS_KG / density_kgpm3
    return sqrt(volume_m3 / (pi * length_share * STATURE_M)) + COVER_M


TRUNK_M = _cylinder_m(0.497, 1030.0, 0.288)
HEAD_M = (HEAD_BREADTH_M + HEAD_LENGTH_M) / 4 + COVER_M
THIGH_M = _cylinder_m(0.100, 1050.0, 0.245)
SHANK_M = _cylinder_m(0.0465, 1090.0, 0.246)

# Capsules: ends (means of two joints each) and radius [m]. Trunk, neck and head (the ears are in
# its middle), thighs, shanks.
ENDS = np.array(
    [
        [11, 12, 5, 6],
        [5, 6, 3, 4],
        [11, 11, 13, 13],
        [12, 12, 14, 14],
        [13, 13, 15, 15],
        [14, 14, 16, 16],
    ]
)
RADIUS_M = np.array([TRUNK_M, HEAD_M, THIGH_M, THIGH_M, SHANK_M, SHANK_M])
WIDEST_M = RADIUS_M.max()
