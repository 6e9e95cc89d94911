"""Where results go: files today, pages and messages later, all behind one Protocol."""

from trecsim.sinks.base import NOBODY, Forgiving, Sink, Sinks, Taken

__all__ = ["NOBODY", "Forgiving", "Sink", "Sinks", "Taken"]
