"""Made data with known truth: rooms, people, detectors, clocks."""
