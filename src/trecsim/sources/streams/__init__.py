"""Live sources: cameras on the network or at this machine, and recordings played as if live.

::

    camera ── thread of FFmpeg ──> newest image ──> StreamSource ──> Frame
              (decodes, dates)     (none waits)     (size, RGB)

Import nothing of it where no live source is used: PyAV is imported with the first `StreamSource`.
"""

from trecsim.sources.streams.as_live import Pace, PosesStream, RecordedStream
from trecsim.sources.streams.stream_address import Address, DeviceAddress, NetworkAddress
from trecsim.sources.streams.stream_counters import StreamCounters
from trecsim.sources.streams.stream_source import StreamSource

__all__ = [
    "Address",
    "DeviceAddress",
    "NetworkAddress",
    "Pace",
    "PosesStream",
    "RecordedStream",
    "StreamCounters",
    "StreamSource",
]
