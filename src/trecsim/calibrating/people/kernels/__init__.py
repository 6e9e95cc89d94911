"""Compiled parts of the calibration from people: loops over images, offsets and observations."""
