"""The commands `trecsim models`."""

from trecsim.cli.terminal import finish, progress_bar


def fetch_first(estimator: str, *, quiet: bool) -> None:
    """Download the model of an estimator if it is missing, with a progress bar."""
    from trecsim.estimators.store import MODELS, is_here, pull

    if estimator in MODELS and not is_here(estimator):
        with progress_bar(f"downloading the model {estimator}, bytes", quiet=quiet) as bar:
            pull(estimator, progress=bar)


def list_(*, json: bool = False) -> None:
    """List the known models and whether they are downloaded.

    Parameters
    ----------
    json
        Print the list as one JSON object.
    """
    from trecsim.estimators.store import MODELS, is_here, models_dir

    rows = [
        {
            "name": entry.name,
            "here": is_here(entry.name),
            "what": entry.what,
            "licence": entry.licence,
            "source": entry.source,
            "bytes": entry.member.size_bytes,
            "sha256": entry.member.sha256,
            "fetched_from": str(entry.package),
            "path": models_dir() / entry.file,
        }
        for entry in MODELS.values()
    ]
    lines = [
        f"{row['name']:10}{'here' if row['here'] else 'missing':10}{row['licence']:12}"
        f"{row['source']:10}{row['what']}"
        for row in rows
    ]
    text = "\n".join([*lines, f"Models are kept in {models_dir()} (or TRECSIM_MODELS)."])
    finish({"models": rows, "folder": models_dir()}, json, text)


def pull(name: str, /, *, json: bool = False) -> None:
    """Download a model and verify it.

    It comes from a pinned release on the package index, through pip and its settings.

    Parameters
    ----------
    name
        Its name in `trecsim models list`.
    json
        Print the summary as one JSON object.
    """
    from trecsim.estimators.store import model, pull

    with progress_bar("bytes", quiet=json) as bar:
        path = pull(name, progress=bar)
    entry = model(name)
    summary = {
        "name": name,
        "path": path,
        "licence": entry.licence,
        "notice": path.with_name(entry.notice_file),
    }
    finish(summary, json, f"{name}: {path} ({entry.licence}, by {entry.source})")


def path(name: str, /, *, json: bool = False) -> None:
    """Print the path of a model.

    Parameters
    ----------
    name
        Its name in `trecsim models list`.
    json
        Print it as one JSON object.
    """
    from trecsim.estimators.store import path_of

    where = path_of(name)
    finish({"name": name, "path": where}, json, str(where))
