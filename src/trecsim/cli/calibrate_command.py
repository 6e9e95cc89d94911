"""The commands `trecsim calibrate`: each kind of calibration in a module of its own."""

from trecsim.cli.calibrate_board import board

__all__ = ["board"]
