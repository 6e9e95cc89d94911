"""Progress while the kernels of the fusion are compiled for the first time."""

import sys

from trecsim.cli.terminal import note, progress_bar


def tell_first_run(*, quiet: bool) -> bool:
    """Write a line to stderr if the compiler's cache is cold; return whether it is.

    Parameters
    ----------
    quiet
        Write nothing.
    """
    from trecsim.doctor import kernels_are_cached

    cached = kernels_are_cached()
    if not quiet and not cached:
        note(
            "first run on this machine: compiling the kernels of the fusion, once; later runs "
            "start at once"
        )
    return not cached


def compile_first(*, quiet: bool) -> None:
    """Compile the kernels if the compiler's cache is cold, with progress on stderr.

    Parameters
    ----------
    quiet
        Show nothing.
    """
    if not tell_first_run(quiet=quiet):
        return
    from trecsim.fusion.warmup import warm_up

    lines = not quiet and not sys.stderr.isatty()
    told = 0
    with progress_bar("compiling kernels", quiet=quiet) as bar:

        def passed(done: int, total: int | None) -> None:
            nonlocal told
            bar(done, total)
            if lines and total and 4 * done // total > told:
                told = 4 * done // total
                note(f"compiling kernels: {done} of {total}")

        warm_up(passed)
