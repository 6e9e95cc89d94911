"""Cameras, rigs, projection and triangulation."""

from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig
from trecsim.geometry.triangulation import triangulate

__all__ = ["Camera", "Rig", "triangulate"]
