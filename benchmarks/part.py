"""One part of the fusion's model, which can be switched off."""

import hashlib
import inspect
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from ablation_inputs import COMMON
from harness.switching import replaced
from trecsim.fusion import model as fusion_model
from trecsim.fusion.model import Model

Figure = tuple[str, str]
"""An input and a figure of it."""


@dataclass(frozen=True, slots=True)
class Part:
    """One part of the model, how it is switched off, and what it is for.

    Attributes
    ----------
    name
        Of the part.
    instead
        What happens without it.
    aims
        The figures that it is for. It is also tracked on all inputs in `COMMON`.
    settings
        Settings of the fusion that switch it off.
    model
        What makes a `Model` without it.
    changes
        What is replaced in the fusion; see `harness.switching.replaced`.
    lag_s
        How far behind the newest image people are reported [s].
    """

    name: str
    instead: str
    aims: tuple[Figure, ...]
    settings: Mapping[str, Any] = field(default_factory=dict)
    model: Callable[[Model], Model] | None = None
    changes: Mapping[str, Any] = field(default_factory=dict)
    lag_s: float = 0.0

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of all inputs on which it is tracked."""
        return tuple(dict.fromkeys((*COMMON, *(name for name, _ in self.aims))))

    @property
    def digest(self) -> str:
        """A digest of what is switched off, and of where it is measured."""
        changes = {**self.settings, **self.changes, "model": self.model, "lag": self.lag_s}
        text = repr((self.inputs, [(path, _text(changes[path])) for path in sorted(changes)]))
        return hashlib.sha256(text.encode()).hexdigest()[:8]

    @contextmanager
    def off(self) -> Iterator[None]:
        """Switch the part off while the context lasts, but for what its settings do."""
        changes = dict(self.changes)
        if self.model is not None:
            changes["model.build"] = _built(self.model)
        with replaced(self.name, changes):
            yield


def _text(value: object) -> str:
    """Return the source of a function, or a value as text."""
    return inspect.getsource(value) if inspect.isfunction(value) else repr(value)


def _built(change: Callable[[Model], Model]) -> Callable[..., Model]:
    build = fusion_model.build

    def changed(*arguments: Any) -> Model:
        return change(build(*arguments))

    return changed
