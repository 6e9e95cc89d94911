"""Which images belong together: 2D poses in, frame sets out."""

from trecsim.sync.buffer import frame_sets

__all__ = ["frame_sets"]
