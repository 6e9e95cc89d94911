"""The colours of people, cameras and curves, in all pictures and reports."""

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#332288", "#882255")
"""Distinguishable for colour-blind people and on paper; neighbours differ in lightness (after Okabe
and Ito)."""
