"""Errors over unknowns and seconds, stability, chance: what `steklov study` finds, as tables."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from . import _steklov
from .errors import SteklovError, near
from .progress import Progress, told_to
from .scene import Scene, settings_of, text_of

if TYPE_CHECKING:
    import pandas


class Study:
    """What a study found.

    `summary` is the JSON object of `steklov study --json`, `tables` has its tables as CSV by their names, `files` are those that were
    written; printed, it is the text of the command.
    """

    def __init__(self, summary: dict[str, Any], text: str, tables: dict[str, str], files: list[str]) -> None:
        self.summary, self.text, self.tables, self.files = summary, text, tables, files

    def __repr__(self) -> str:
        return f"<steklov.Study of {self.summary['title']}: {', '.join(self.tables)}>"

    def __str__(self) -> str:
        return self.text

    def frame(self, name: str | None = None) -> pandas.DataFrame:
        """A table of pandas by its name, the first one without a name."""
        import pandas

        name = next(iter(self.tables)) if name is None else name
        if name not in self.tables:
            raise KeyError(f"{name!r} is no table of this study{near(name, list(self.tables))}")
        return pandas.read_csv(io.StringIO(self.tables[name]))


def study(
    scene: Scene,
    what: str = "convergence",
    *,
    strategies: Sequence[str] = (),
    multipliers: Sequence[str] = (),
    repeat: int = 1,
    folder: str | os.PathLike[str] | None = None,
    progress: Progress = None,
    **overrides: Any,
) -> Study:
    """Studies a scene: `what` is "convergence", "inf-sup", "stability", "solvers", "stochastic", "multiscale", "coupling" or
    "quantities".

    A study of convergence compares `strategies` of refinement (all, if none are named), each with every one of the `multipliers`; seconds
    are medians of `repeat` runs. With a `folder` the HDF5 file, the tables and the charts of `steklov study` are written into it. Needs a
    package that was built with HDF5.
    """
    if not hasattr(_steklov, "study"):
        raise SteklovError("this package was built without HDF5, which studies need: see the guide, or study by the command steklov")
    text, name = text_of(scene)
    folder = None if folder is None else os.fspath(folder)
    with told_to(progress) as tell:
        found = _steklov.study(text, name, settings_of(overrides), what, list(strategies), list(multipliers), repeat, folder, tell)
    summary, told, tables, files = found
    return Study(json.loads(summary), told, dict(tables), [os.fspath(file) for file in files])
