"""What all benchmarks share: figures and their spread, the machine, comparing, storing, tables.

It imports neither NumPy nor trecsim, so that a benchmark can say first how many threads it wants.
"""
