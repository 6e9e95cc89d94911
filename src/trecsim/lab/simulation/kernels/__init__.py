"""Compiled kernels of the simulation; each has a slow, obvious twin in the tests."""

from trecsim.lab.simulation.kernels.sampling_kernels import hidden_by_bodies, remember

__all__ = ["hidden_by_bodies", "remember"]
