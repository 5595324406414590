"""One scene at many values of its keys."""

import itertools
import json
import os

import numpy

from . import _steklov
from .errors import SteklovError, near
from .progress import told_to
from .scene import key_of, settings_of, text_of, toml


class Sweep:
    """A scene that is solved at many points.

    `keys` are the varied keys and `points` their values, a tuple for each point; `summaries` has the JSON object of each point, None where
    it has no solution, and `messages` why, None where it has one.
    """

    def __init__(self, swept, keys, points):
        self._swept = swept
        self.keys, self.points = keys, points
        known = swept.outcomes()
        self.summaries = [json.loads(text) if solved else None for solved, text in known]
        self.messages = [None if solved else text for solved, text in known]
        self._paths, self._numbers = swept.numbers()

    def __len__(self):
        return len(self.points)

    def __repr__(self):
        failed = sum(message is not None for message in self.messages)
        return f"<steklov.Sweep of {', '.join(self.keys)}: {len(self)} points, {failed} failed>"

    def __getitem__(self, name):
        """The values of a varied key, or the numbers of all points by their path in the JSON object, NaN where a point has none."""
        if name in self.keys:
            return numpy.array([point[self.keys.index(name)] for point in self.points])
        if name not in self._paths:
            raise KeyError(f"{name!r} is no number of these points{near(name, list(self.keys) + self._paths)}")
        return self._numbers[:, self._paths.index(name)]

    @property
    def converged(self):
        """Whether each point reached its aim, as an array."""
        return numpy.array([bool(summary and summary["converged"]) for summary in self.summaries])

    def frame(self):
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

    def plot(self, path, key=None, *, ax=None):
        """Draws a number over a varied key, the band of J's uncertainty around it where it is `energy_extrapolated`; returns the axes."""
        from .pictures import plot_sweep

        return plot_sweep(self, path, key, ax)

    def csv(self, path=None):
        """The table of `steklov sweep` as a text, or written into a file."""
        text = self._swept.csv()
        if path is None:
            return text
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return None

    def save(self, path, *, replace=False):
        """Writes the file of `steklov sweep`; needs a package that was built with HDF5."""
        if not hasattr(self._swept, "save"):
            raise SteklovError("this package was built without HDF5: write the table by csv, or sweep by the command steklov")
        self._swept.save(os.fspath(path), replace)


def sweep(scene, vary=None, *, zip=False, points=None, threads=None, client=None, progress=None, **overrides):
    """Solves a scene at many values of its keys, several points at once; every point has the bits of `solve`.

    `vary` is a dictionary of keys and their values, `{"parameters.load": [1, 2, 3]}`: all combinations, the last key running first, with
    `zip` the first values of all keys, the second ones, and so on. `points` instead is a list of dictionaries or a table of pandas.
    `client` is one of Dask, whose workers then solve the points. Points that have no solution stay in the result with their message.
    """
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


def points_of(vary, paired, points):
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


def plain(value):
    """A number of numpy as one of Python."""
    return value.item() if isinstance(value, numpy.generic) else value
