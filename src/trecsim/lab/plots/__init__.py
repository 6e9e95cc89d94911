"""Pictures; they need matplotlib, an optional extra."""
