"""Where images and 2D poses come from: videos, and files that other programs wrote."""

from trecsim.sources.poses_files import read_poses
from trecsim.sources.prefetch import prefetched
from trecsim.sources.video import VideoFile, VideoInfo, probe

__all__ = ["VideoFile", "VideoInfo", "prefetched", "probe", "read_poses"]
