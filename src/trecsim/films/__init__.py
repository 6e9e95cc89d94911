"""Films and pictures of tracks: over the videos of the cameras, in 3D, and on the floor plan."""

from trecsim.films.filming import Filmed, FilmSettings, render

__all__ = ["FilmSettings", "Filmed", "render"]
