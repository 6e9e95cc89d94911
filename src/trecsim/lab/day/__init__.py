"""The report of a day: alerts and what was decided about them, counts, dwell and density."""
