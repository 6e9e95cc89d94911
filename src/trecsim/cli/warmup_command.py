"""The command `trecsim warmup`."""

from trecsim.cli.terminal import finish, progress_bar


def warmup(*, json: bool = False) -> None:
    """Compile the kernels of the fusion and the rules now instead of at the first run.

    The compiled code is kept for later runs: in the directory NUMBA_CACHE_DIR, if it is set,
    otherwise beside the installed package or in the user's cache. After an update the kernels are
    compiled again.

    Parameters
    ----------
    json
        Print the result as one JSON object.
    """
    from pathlib import Path

    from numba.core import config

    from trecsim.compiler import cache_folder
    from trecsim.errors import SetupError
    from trecsim.fusion import kernels, warmup
    from trecsim.safety.ready import make_ready

    if config.DISABLE_JIT:
        raise SetupError(
            "the compiler is off: NUMBA_DISABLE_JIT is set; unset it to compile the kernels"
        )
    with progress_bar("kernels", quiet=json) as bar:
        warmup.warm_up(bar)
    make_ready()
    folder = cache_folder(Path(kernels.__path__[0]))
    if folder is None:
        raise SetupError(
            "the kernels were compiled, but there is no writable directory to keep them; set "
            "NUMBA_CACHE_DIR to one"
        )
    kept = len(list(folder.glob("*.nbc")))
    finish({"kernels": kept, "folder": str(folder)}, json, f"{kept} compiled kernels in {folder}")
