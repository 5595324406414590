"""One scene at many values of its keys."""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy

from . import _steklov
from .errors import SteklovError, near
from .progress import Progress, told_to
from .scene import Scene, key_of, settings_of, text_of, toml

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes


class Sweep:
    """A scene that is solved at many points.

    `keys` are the varied keys and `points` their values, a tuple for each point; `summaries` has the JSON object of each point, None where
    it has no solution, and `messages` why, None where it has one.
    """

    def __init__(self, swept: _steklov.Swept, keys: list[str], points: list[tuple[Any, ...]]) -> None:
        self._swept = swept
        self.keys, self.points = keys, points
        known = swept.outcomes()
        self.summaries = [json.loads(text) if solved else None for solved, text in known]
        self.messages = [None if solved else text for solved, text in known]
        self._paths, self._numbers = swept.numbers()

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        failed = sum(message is not None for message in self.messages)
        return f"<steklov.Sweep of {', '.join(self.keys)}: {len(self)} points, {failed} failed>"

    def __getitem__(self, name: str) -> numpy.ndarray[Any, Any]:
        """The values of a varied key, or the numbers of all points by their path in the JSON object, NaN where a point has none."""
        if name in self.keys:
            values = [point[self.keys.index(name)] for point in self.points]
            if all(isinstance(value, (bool, int, float, str)) for value in values):
                return numpy.array(values)
            column = numpy.empty(len(values), dtype=object)
            column[:] = values
            return column
        if not self._paths:
            return numpy.full(len(self), numpy.nan)  # no point has a solution: `messages` tells why
        if name not in self._paths:
            raise KeyError(f"{name!r} is no number of these points{near(name, list(self.keys) + self._paths)}")
        return self._numbers[:, self._paths.index(name)]

    @property
    def converged(self) -> numpy.ndarray[Any, Any]:
        """Whether each point reached its aim, as an array."""
        return numpy.array([bool(summary and summary["converged"]) for summary in self.summaries])

    def frame(self) -> pandas.DataFrame:
        """All points as a table of pandas: the varied keys, what became of each point, and its numbers."""
        import pandas

        text = [summary or {} for summary in self.summaries]
        told = {
            "converged": self.converged,
            "reason": [summary.get("reason") for summary in text],
            "doubts": [" ".join(summary.get("estimate_doubts", [])) for summary in text],
            "message": self.messages,
        }
        columns = {key: [point[k] for point in self.points] for k, key in enumerate(self.keys)}
        numbers = pandas.DataFrame(self._numbers, columns=self._paths)
        return pandas.concat([pandas.DataFrame({**columns, **told}), numbers], axis=1)

    def plot(self, path: str, key: str | None = None, *, ax: Axes | None = None) -> Axes:
        """Draws a number over a varied key, the band of J's uncertainty around it where it is `energy_extrapolated`; returns the axes."""
        from .pictures import plot_sweep

        return plot_sweep(self, path, key, ax)

    def csv(self, path: str | os.PathLike[str] | None = None) -> str | None:
        """The table of `steklov sweep` as a text, or written into a file."""
        text = self._swept.csv()
        if path is None:
            return text
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return None

    def save(self, path: str | os.PathLike[str], *, replace: bool = False) -> None:
        """Writes the file of `steklov sweep`; needs a package that was built with HDF5."""
        if not hasattr(self._swept, "save"):
            raise SteklovError("this package was built without HDF5: write the table by csv, or sweep by the command steklov")
        self._swept.save(os.fspath(path), replace)


def sweep(
    scene: Scene,
    vary: Mapping[str, Iterable[Any]] | None = None,
    *,
    zip: bool = False,
    points: Sequence[Mapping[str, Any]] | pandas.DataFrame | None = None,
    threads: int | None = None,
    client: Any = None,
    progress: Progress = None,
    **overrides: Any,
) -> Sweep:
    """Solves a scene at many values of its keys, several points at once; every point has the bits of `solve`.

    `vary` is a dictionary of keys and their values, `{"parameters.load": [1, 2, 3]}`: all combinations, the last key running first, with
    `zip` the first values of all keys, the second ones, and so on. `points` instead is a list of dictionaries or a table of pandas.
    `client` is one of Dask, whose workers then solve the points. Points that have no solution stay in the result with their message.
    """
    if threads is not None and (threads < 1 or client is not None):
        raise ValueError("threads is 1 or more" if client is None else "threads are those of the client's workers: leave one of both out")
    keys, rows = points_of(vary, zip, points)
    text, name = text_of(scene)
    written = [[toml(value, key) for key, value in zip_of(keys, row)] for row in rows]
    settings = settings_of(overrides)
    with told_to(progress) as tell:
        # too many points are refused with the time that they would take
        if client is None or len(rows) > _steklov.MOST_POINTS:
            swept = _steklov.sweep(text, name, settings, keys, written, threads, tell)
        else:
            from .cluster import solve_points

            known = solve_points(client, (text, name, settings, keys), written, tell)
            swept = _steklov.swept(text, name, settings, keys, written, known)
    return Sweep(swept, keys, rows)


zip_of = zip


def points_of(vary: Any, paired: bool, points: Any) -> tuple[list[str], list[tuple[Any, ...]]]:
    """The varied keys, and their values point by point."""
    if (vary is None) == (points is None):
        raise TypeError("give either the values of keys by `vary`, or `points`")
    if points is not None:
        rows = points.to_dict("records") if hasattr(points, "to_dict") else list(points)
        if not rows:
            raise ValueError("points is empty: give one point at least")
        names = list(rows[0])
        for k, row in enumerate(rows):
            if set(row) != set(names):
                raise ValueError(f"points[{k}] has the keys {', '.join(map(str, row))}, and points[0] {', '.join(map(str, names))}")
        return [key_of(name) for name in names], [tuple(plain(row[name]) for name in names) for row in rows]
    lists = {}
    for name, values in vary.items():
        if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
            raise TypeError(f"the values of {name} are {values!r}: give a list of them")
        if key_of(name) in lists:
            raise ValueError(f"{name} is varied twice: vary it once, with all its values")
        if hasattr(values, "__len__") and len(values) > 10 * _steklov.MOST_POINTS:
            raise ValueError(f"{name} has {len(values)} values, and a sweep {_steklov.MOST_POINTS} points at most: take fewer")
        lists[key_of(name)] = [plain(value) for value in values]
        if not lists[key_of(name)]:
            raise ValueError(f"{name} has no values: give one at least")
    if not lists:
        raise ValueError("vary has no keys: name one, such as \"parameters.load\"")
    if not paired:
        count = numpy.prod([float(len(values)) for values in lists.values()])
        if count > 100 * _steklov.MOST_POINTS:
            raise ValueError(f"these are {count:.3g} points, and the most are {_steklov.MOST_POINTS}: take fewer values")
        return list(lists), list(itertools.product(*lists.values()))
    counts = {name: len(values) for name, values in lists.items()}
    if len(set(counts.values())) > 1:
        raise ValueError("with zip all keys need as many values: " + ", ".join(f"{name} has {n}" for name, n in counts.items()))
    return list(lists), list(zip_of(*lists.values()))


def plain(value: Any) -> Any:
    """A number of numpy as one of Python."""
    return value.item() if isinstance(value, numpy.generic) else value
