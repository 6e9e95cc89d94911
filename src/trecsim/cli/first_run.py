"""What a command says before the fusion's kernels are compiled for the first time."""

from trecsim.cli.terminal import note


def tell_first_run(*, quiet: bool) -> None:
    """Write a line to stderr if the compiler's cache is empty.

    Parameters
    ----------
    quiet
        Write nothing.
    """
    from trecsim.doctor import kernels_are_cached

    if not quiet and not kernels_are_cached():
        note(
            "first run on this machine: the kernels are compiled once, which takes about a minute "
            "of processor time; later runs start at once"
        )
