"""Files of results: tracks, timings, 2D poses and ground truth."""
