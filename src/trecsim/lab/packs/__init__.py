"""Scenario packs: simulated sites with their rules, on which something really happens."""
