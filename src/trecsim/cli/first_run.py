"""What a command does before the fusion's kernels are compiled for the first time."""

from trecsim.cli.terminal import note, progress_bar


def tell_first_run(*, quiet: bool) -> bool:
    """Write a line to stderr if the compiler's cache is empty; return whether it is.

    Parameters
    ----------
    quiet
        Write nothing.
    """
    from trecsim.doctor import kernels_are_cached

    cached = kernels_are_cached()
    if not quiet and not cached:
        note(
            "first run on this machine: the kernels are compiled once, which takes up to a minute "
            "of processor time; later runs start at once"
        )
    return not cached


def compile_first(*, quiet: bool) -> None:
    """Compile the kernels if the compiler's cache is empty, and show the progress.

    Parameters
    ----------
    quiet
        Show nothing.
    """
    if not tell_first_run(quiet=quiet):
        return
    from trecsim.fusion.warmup import warm_up

    with progress_bar("compiling kernels", quiet=quiet) as bar:
        warm_up(bar)
