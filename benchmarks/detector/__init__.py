"""Measure a 2D detector: the recorded one on Shelf, and the simulated one made after it."""
