"""The commands `trecsim site check` and `trecsim site schema`."""

from pathlib import Path

from trecsim.cli.terminal import finish, note


def check(site: Path, /, *, json: bool = False) -> None:
    """Check a site file and everything it names.

    Looks whether the rig can be read, each video opened and belongs to a camera of the rig, and
    the estimator is installed. All that is wrong is told at once, by line.

    Parameters
    ----------
    site
        The site file.
    json
        Print the summary as one JSON object.
    """
    from trecsim.sites.check import check_site

    checked = check_site(site)
    for remark in checked.remarks:
        note(remark)
    settings = checked.file.site
    summary = {
        "site": settings.name,
        "cameras": list(checked.rig.names),
        "sources": {
            camera: {"video": source.video, "seconds": checked.videos[camera].duration_s}
            for camera, source in settings.sources.items()
        },
        "poses": settings.poses.file if settings.poses else None,
        "estimator": settings.estimator.name if settings.sources else None,
        "remarks": checked.remarks,
    }
    inputs = f"{len(settings.sources)} videos" if settings.sources else f"{summary['poses']}"
    finish(summary, json, f"{site}: good ({len(checked.rig)} cameras, {inputs})")


def schema(*, json: bool = False) -> None:
    """Print the JSON schema of site files.

    Editors that know TOML (Even Better TOML, taplo) complete and check a site file that begins
    with `#:schema trecsim-site.schema.json`, when that file lies beside it:
    `trecsim site schema > trecsim-site.schema.json`.

    Parameters
    ----------
    json
        Print it on one line.
    """
    from json import dumps

    from trecsim.sites import site_schema

    found = site_schema()
    finish(found, json, dumps(found, indent=2))
