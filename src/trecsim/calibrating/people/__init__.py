"""Cameras calibrated from people who just walk, and watched by them later.

::

    2D poses ──> tracklets ──> vertical, floor tracks ──> pairs of cameras ──> tree ──> chains
             ──> bundle adjustment ──> parts against each other ──> verdict

`trecsim.calibrating.people.finding` reads like this from top to bottom. The numbers stand in
`tuning`; where they come from is said there.
"""
