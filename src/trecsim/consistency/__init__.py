"""Whether 2D poses and rig fit together: remarks on clocks, image sizes and cameras."""

from trecsim.consistency.accumulator import Consistency
from trecsim.consistency.thresholds import Thresholds

__all__ = ["Consistency", "Thresholds"]
