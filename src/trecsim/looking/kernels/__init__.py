"""Compiled kernels of the looks; each has an obvious twin in ``tests/reference_looking.py``."""

from trecsim.looking.kernels.found_people import found_people

__all__ = ["found_people"]
