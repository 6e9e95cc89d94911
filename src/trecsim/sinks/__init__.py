"""Where results go: files today, pages and messages later, all behind one Protocol."""

from trecsim.sinks.base import NOBODY, Sink, Sinks, Taken

__all__ = ["NOBODY", "Sink", "Sinks", "Taken"]
