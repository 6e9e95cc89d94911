"""How large numbers in files may be; what lies beyond is a slip of units or a broken file."""

FARTHEST_M = 1e6
"""No place, and no standard deviation of one, is farther than this [m]."""

LATEST_S = 1e11
"""No time is farther from zero than this [s]: three thousand years."""
