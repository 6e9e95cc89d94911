"""2D pose models behind one Protocol, found by entry point.

An estimator is anything that is called with a frame and returns the people in it. A package adds
one by an entry point in the group ``trecsim.estimators``: a function
``load(argument: str, **settings) -> Estimator2D``. Its module may have a function
``check(argument: str, **settings)``: it raises `ConfigError` if they are wrong and loads nothing.
"""

from difflib import get_close_matches
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Protocol, runtime_checkable

from trecsim.errors import ConfigError, SetupError
from trecsim.skeleton import SKELETONS
from trecsim.values import Frame, Poses2D

GROUP = "trecsim.estimators"


@runtime_checkable
class Estimator2D(Protocol):
    """Finds people's key points in one image.

    Attributes
    ----------
    skeleton
        Name of the skeleton it reports, a key of `trecsim.skeleton.SKELETONS`.

    Notes
    -----
    The result depends on the frame alone. Scores run from 0 to 1 and rise with certainty; they are
    the model's own, not calibrated between models, so each estimator drops by itself what its
    model is known to score too low to be true. Key points it drops are NaN with score 0; a person
    without any is left out.

    Two more attributes are used where an estimator has them: ``image_limit_px``, the (width,
    height) into which it scales images anyway, so that they need not come larger (see
    `image_limit_px`), and ``workers``, how many threads may call it at the same time (see
    `workers`).
    """

    skeleton: str

    def __call__(self, frame: Frame) -> Poses2D:
        """Find the people; key points are pixels of `frame`'s image."""
        ...


def image_limit_px(estimator: Estimator2D) -> tuple[int, int] | None:
    """Return the (width, height) that images need not exceed; None if they may have any size."""
    limit: tuple[int, int] | None = getattr(estimator, "image_limit_px", None)
    return limit


def workers(estimator: Estimator2D) -> int:
    """Return how many threads may call `estimator` at the same time; 1 unless it says more."""
    return max(1, int(getattr(estimator, "workers", 1)))


def names() -> list[str]:
    """Return the names of the installed estimators."""
    return sorted({point.name for point in entry_points(group=GROUP)})


def check(spec: str, **settings: object) -> None:
    """Check an estimator's name and settings without loading its model, as far as it offers that.

    Parameters
    ----------
    spec
        As for `load`.
    settings
        The estimator's own.

    Raises
    ------
    ConfigError
        When no estimator has that name, or a setting is wrong.
    """
    name, _, argument = spec.partition(":")
    try:
        module = import_module(_found(name).module)
    except ImportError:  # `load` says what is missing
        return
    checks = getattr(module, "check", None)
    if callable(checks):
        checks(argument, **settings)


def load(spec: str, **settings: object) -> Estimator2D:
    """Return the estimator that `spec` names, ready to work.

    Parameters
    ----------
    spec
        Its name, or ``name:argument``: ``movenet``, ``onnx:model.onnx``, ``rtmlib:rtmo-m``.
    settings
        The estimator's own.

    Raises
    ------
    ConfigError
        When no estimator has that name, or a setting is wrong.
    SetupError
        When something it needs is not installed or not here.
    """
    name, _, argument = spec.partition(":")
    found = _found(name)
    try:
        factory = found.load()
    except (ImportError, AttributeError) as error:
        raise SetupError(
            f"estimator {name!r} ({found.value}) is installed but does not load: {error}"
        ) from error
    return _checked(spec, factory(argument, **settings))


def _found(name: str) -> EntryPoint:
    found = {point.name: point for point in entry_points(group=GROUP)}
    if name not in found:
        near = get_close_matches(name, found, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        known = ", ".join(sorted(found)) or "none"
        raise ConfigError(f"no estimator called {name!r} is installed; known: {known}{hint}")
    return found[name]


def _checked(spec: str, estimator: object) -> Estimator2D:
    if not (isinstance(estimator, Estimator2D) and callable(estimator)):
        raise SetupError(
            f"estimator {spec!r} is no estimator: it must be callable and have `skeleton`, "
            f"got {type(estimator).__name__}"
        )
    if estimator.skeleton not in SKELETONS:
        raise SetupError(
            f"estimator {spec!r} reports the skeleton {estimator.skeleton!r}; known: "
            f"{', '.join(sorted(SKELETONS))}"
        )
    return estimator
