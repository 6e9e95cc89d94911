"""The command `trecsim warmup`."""

from trecsim.cli.terminal import finish, progress_bar


def warmup(*, json: bool = False) -> None:
    """Compile what is compiled at the first run, now.

    The compiled code is kept for later runs: in the directory that NUMBA_CACHE_DIR names, else
    beside the installed package, else in the user's cache. After an update it is compiled anew.

    Parameters
    ----------
    json
        Print the result as one JSON object.
    """
    from pathlib import Path

    from trecsim.compiler import cache_folder
    from trecsim.errors import SetupError
    from trecsim.fusion import kernels, warmup

    with progress_bar("kernels", quiet=json) as bar:
        warmup.warm_up(bar)
    folder = cache_folder(Path(kernels.__path__[0]))
    if folder is None:
        raise SetupError(
            "the kernels were compiled, but no directory can be written to that would keep them; "
            "set NUMBA_CACHE_DIR to one that can"
        )
    kept = len(list(folder.glob("*.nbc")))
    finish({"kernels": kept, "folder": str(folder)}, json, f"{kept} kernels are in {folder}")
