"""The colours that tell people, cameras and curves apart, in every picture of paths and report."""

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#332288", "#882255")
"""Told apart by colour-blind people too, and on paper; neighbours differ in lightness (after Okabe
and Ito)."""
