"""Films and pictures of tracks: over the videos of the cameras, in 3D, and on the floor plan."""

from trecsim.films.film_settings import FilmSettings
from trecsim.films.filming import Filmed, render

__all__ = ["FilmSettings", "Filmed", "render"]
