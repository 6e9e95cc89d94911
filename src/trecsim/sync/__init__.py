"""Which images belong together: 2D poses in, frame sets out."""

from trecsim.sync.buffer import FrameSetBuffer, frame_sets

__all__ = ["FrameSetBuffer", "frame_sets"]
