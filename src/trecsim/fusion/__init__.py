"""The numeric core: who is who, where, and how sure. It knows no files, clocks or threads."""

from trecsim.fusion.settings import FusionSettings
from trecsim.fusion.tracker import Tracker

__all__ = ["FusionSettings", "Tracker"]
