"""What stays on the disk: tracks as CSV and Parquet, written so that a crash costs seconds."""
