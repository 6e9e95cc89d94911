"""Tracks in the formats of other tools: motion capture, animation, pedestrians, tables.

One writer per format behind one Protocol (:class:`trecsim.export.base.Writer`); the ending of a
file name chooses it. Writers are pure: they get what is to be written and a path, and nothing else.
"""

from trecsim.export.exporting import Exported, ExportSettings, export_tracks

__all__ = ["ExportSettings", "Exported", "export_tracks"]
