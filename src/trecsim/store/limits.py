"""Largest numbers that files may hold; larger ones come from wrong units or damage."""

FARTHEST_M = 1e6
"""Largest coordinate and largest standard deviation of a position [m]."""

LATEST_S = 1e11
"""Largest absolute time [s]: 3000 years."""
