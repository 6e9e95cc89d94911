"""Names in files, and what the files of a made scene or of a recording are called in its folder."""

POSES_FORMAT = "trecsim.poses2d/1"
RIG, POSES, TRUTH = "rig.toml", "poses.jsonl", "truth.npz"
