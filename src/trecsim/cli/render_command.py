"""The command `trecsim render`."""

from pathlib import Path

from trecsim.cli.terminal import counted_people, finish, progress_bar


def render(
    tracks: Path,
    out: Path,
    /,
    *videos: str,
    site: Path | None = None,
    rig: Path | None = None,
    events: Path | None = None,
    forecasts: Path | None = None,
    from_s: float | None = None,
    to_s: float | None = None,
    at_s: float | None = None,
    rate_hz: float | None = None,
    width: int = 1280,
    height: int = 720,
    trail_s: float = 10.0,
    title: str = "",
    json: bool = False,
) -> None:
    """Make a film or a picture of tracks: over the videos, in 3D and on the floor plan.

    Without videos, the 3D view and the plan alone are shown. What lies in the folder of the tracks
    is taken by itself: `rig.toml`, `events.jsonl`, `forecast.jsonl`.

    Parameters
    ----------
    tracks
        A file `*.csv` or `*.parquet`, or the directory of a recording.
    out
        The film, `*.mp4`, or the picture, `*.png` or `*.jpg`.
    videos
        Videos of cameras: `NAME=VIDEO`, or VIDEO if the file is named like the camera.
    site
        A site file: its videos, rig, zones, lines, edges and walls.
    rig
        The cameras, in any format that `trecsim rig show` reads.
    events
        Events of rules, as `trecsim assess` writes them.
    forecasts
        Forecasts, as `trecsim forecast` writes them.
    from_s
        Begin this long after the first time of the tracks [s].
    to_s
        End this long after the first time of the tracks [s].
    at_s
        Moment of a picture after the first time of the tracks [s] (default: with most people).
    rate_hz
        Frames per second (default: that of the tracks, at most 30).
    width
        Width of the image [px].
    height
        Height of the image [px].
    trail_s
        Length of the paths behind people [s].
    title
        Text above the 3D view.
    json
        Print the summary as one JSON object.
    """
    from trecsim.cli.estimate_command import cameras_of
    from trecsim.film_places import film_input
    from trecsim.films import FilmSettings
    from trecsim.films import render as make

    files = cameras_of(videos) if videos else {}
    settings = FilmSettings(width, height, rate_hz, from_s, to_s, at_s, trail_s, title)
    shown = film_input(tracks, rig=rig, site=site, videos=files, events=events, forecasts=forecasts)
    with progress_bar("images", quiet=json, time_left=True) as bar:
        made = make(tracks, out, shown, settings, bar)
    length = "" if made.frames == 1 else f", {made.frames} images, {made.to_s - made.from_s:.2f} s"
    over = f", over {len(made.cameras)} videos" if made.cameras else ""
    text = f"{out}: {counted_people(made.people)}{length}{over}"
    finish({name: getattr(made, name) for name in made.__slots__}, json, text)
