"""What can go wrong, as a person on site would sort it.

::

    Error                    the command ends with exit code 1
    ├── SetupError           the machine lacks something: an extra, a model, disk space
    └── InputError           what the user gave is wrong: exit code 2
        ├── CalibrationError     a camera or a rig
        └── ConfigError          a site file or a setting

Every message says which thing, what was expected, what was found, and what to do. Passwords in
addresses are left out of it.
"""

from trecsim.redaction import redacted


class Error(Exception):
    """Anything trecsim reports on purpose; its text is written for the person on site."""

    exit_code = 1

    def __init__(self, *args: object) -> None:
        super().__init__(*(redacted(arg) if isinstance(arg, str) else arg for arg in args))


class SetupError(Error):
    """The machine lacks something: an optional package, a model file, space on the disk."""


class InputError(Error):
    """A file, stream or argument the user gave is wrong."""

    exit_code = 2


class CalibrationError(InputError):
    """A camera or rig that cannot be right."""


class ConfigError(InputError):
    """A site file or setting that cannot be right."""
