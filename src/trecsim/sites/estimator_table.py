"""The table `[estimator]` of a site file: which 2D pose estimator, and its own settings."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, ConfigDict, Field, ValidationInfo

from trecsim.toml_models import Table
from trecsim.toml_models.table import beside_the_file

_TAKES_A_FILE = "onnx"


def _file_beside(name: str, info: ValidationInfo) -> str:
    """Return an estimator's name; a file in it is as seen from the folder of the site file."""
    kind, _, argument = name.partition(":")
    if kind != _TAKES_A_FILE or not argument:
        return name
    return f"{kind}:{beside_the_file(Path(argument), info)}"


class EstimatorTable(Table):
    """The 2D pose estimator; keys that are not listed here are its own settings."""

    model_config = ConfigDict(extra="allow")

    name: Annotated[str, AfterValidator(_file_beside)] = "movenet"
    """An installed estimator, with its argument after a colon: `onnx:model.onnx`."""

    cores: Annotated[float, Field(gt=0.0, le=1024.0)] | None = None
    """Live cameras: how many processor cores the estimator may use on average; default: all."""

    budget: Annotated[float, Field(gt=0.0, le=1.0)] | None = None
    """Recordings: share of the work of looking at every image; default: all images."""

    def settings(self) -> dict[str, Any]:
        """Return the estimator's own settings."""
        return dict(self.model_extra or {})
