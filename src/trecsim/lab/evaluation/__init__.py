"""How good tracks are, measured against a known truth."""
