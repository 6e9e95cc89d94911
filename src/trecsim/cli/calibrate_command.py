"""The commands `trecsim calibrate`: each kind of calibration in a module of its own."""

from trecsim.cli.calibrate_board import board
from trecsim.cli.calibrate_check import check, repair, revoke
from trecsim.cli.calibrate_floor import floor
from trecsim.cli.calibrate_intrinsics import intrinsics
from trecsim.cli.calibrate_people import people
from trecsim.cli.calibrate_rig import rig

__all__ = ["board", "check", "floor", "intrinsics", "people", "repair", "revoke", "rig"]
