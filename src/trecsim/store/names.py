"""What the files of a made scene or of a recording are called in its folder."""

RIG, POSES, TRUTH = "rig.toml", "poses.jsonl", "truth.npz"
