"""Camera model, rig, projection and its derivative, distortion, triangulation."""
