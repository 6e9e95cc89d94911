"""Names of formats, and of the files in the folder of a synthetic scene or a recording."""

POSES_FORMAT = "trecsim.poses2d/1"
RIG, POSES, TRUTH = "rig.toml", "poses.jsonl", "truth.npz"
SITE, TRUTH_EVENTS = "site.toml", "truth-events.jsonl"
TRACKS = "tracks.parquet"
LIVE = ".live"
"""Marks the recording of a live site, which retention may delete."""
