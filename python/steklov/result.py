"""What a solution gives."""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy

from .errors import SteklovError, near

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

    from . import _steklov

# arrays by their names
Table = dict[str, Any]


def with_names(table: Table) -> Table:
    """The table with names of sides and bodies as an array, "" for none."""
    for column in ("side", "body"):
        if column in table:
            table[column] = numpy.array([name or "" for name in table[column]], dtype=str)
    return table


class Quantities(Mapping[str, float]):
    """All numbers of a result by their paths in the JSON object: `quantities["contact.force.y"]`."""

    def __init__(self, numbers: Iterable[tuple[str, float]]) -> None:
        self._numbers = dict(numbers)

    def __getitem__(self, path: str) -> float:
        try:
            return self._numbers[path]
        except KeyError:
            raise KeyError(f"{path!r} is no number of this result{near(path, self._numbers)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._numbers)

    def __len__(self) -> int:
        return len(self._numbers)

    def __repr__(self) -> str:
        return "\n".join(f"{path} = {value!r}" for path, value in self._numbers.items())

    def series(self, name: str | None = None) -> pandas.Series:
        """The numbers as a row of pandas."""
        import pandas

        return pandas.Series(self._numbers, name=name)


class Result:
    """A scene that is solved.

    `summary` is the JSON object of `steklov solve --json`, `quantities` its numbers by their paths, `contact` the table of all contact
    nodes and `interfaces` that of each interface between bodies by its name: dictionaries of numpy arrays. Trust the numbers to their
    errors where `converged` holds and `doubts` is empty.
    """

    def __init__(self, solved: _steklov.Solved) -> None:
        self._solved = solved
        self.summary: dict[str, Any] = json.loads(solved.json())
        self.quantities = Quantities(solved.numbers())
        self.contact = with_names(solved.contact())
        self.interfaces = {name: with_names(table) for name, table in solved.interfaces().items()}

    @property
    def converged(self) -> bool:
        """Whether the run reached its aim."""
        return self.summary["converged"]

    @property
    def doubts(self) -> list[str]:
        """Why the estimate is not to be trusted, words; empty if it is."""
        return self.summary["estimate_doubts"]

    def at(self, points: Any) -> Table:
        """Displacement, stress (xx, yy, xy) and von Mises stress at points, an array whose last axis has x and y.

        A dictionary of arrays with the axes of the points: NaN where no body is, and stresses NaN with `stress_unbounded` where they
        are infinite. Of random input the fields are those of its mean. A point on the boundary has the values of the boundary; `body`
        names the body of each point where there are several, "" where none is.
        """
        points = numpy.asarray(points, dtype=float)
        if points.ndim == 0 or points.shape[-1] != 2:
            raise ValueError(f"points have the shape {points.shape}: the last axis has x and y")
        table = with_names(self._solved.at(numpy.ascontiguousarray(points.reshape(-1, 2))))
        del table["s"], table["point"]
        return {name: numpy.asarray(column).reshape(points.shape[:-1] + numpy.shape(column)[1:]) for name, column in table.items()}

    def along(self, where: Any, points: int = 101) -> Table:
        """Results along a side, by its name, or along the line from one point to another, at so many points (2 to 10,000).

        A dictionary of arrays, `s` the distance from the beginning. On a side, with n out of the body and t the normal turned by +90
        degrees, there are also n, u·n, u·t, n·σn (negative in compression), t·σn and t·σt; its points are those of the mesh.
        """
        if isinstance(where, str):
            table = self._solved.along_side(where)
            if table is None:
                raise KeyError(f"{where!r} is no side of this scene{near(where, self._solved.sides())}")
            return table
        ends = numpy.asarray(where, dtype=float)
        if ends.shape != (2, 2):
            raise ValueError(f"a line is the name of a side or two points, not an array of the shape {ends.shape}")
        return with_names(self._solved.along_line(*ends.tolist(), points))

    @functools.cached_property
    def fields(self) -> Table:
        """The fields on an unstructured grid: `points`, cells by the numbers of their points in `lines` (the boundary), `triangles` and
        `quads`, and dictionaries of arrays `point_data` and `cell_data`, the cells in that order: the arrays of the result file.
        `enlargement` is the factor at which displacements are drawn.
        """
        return self._solved.fields()

    def plot(self, field: str = "von_mises", *, ax: Axes | None = None, enlarge: float | None = None) -> Axes:
        """Draws the deformed body, coloured by "von_mises", "xx", "yy", "xy", "displacement", "ux" or "uy", on a grid also by "young" or
        "poisson"; returns the axes of matplotlib. Displacements are enlarged to be seen, or by `enlarge`. Colours beyond the arrows
        belong to singular points.
        """
        from .pictures import plot

        return plot(self, field, ax, enlarge)

    def plot_contact(self, *, ax: Axes | None = None) -> Axes:
        """Draws pressure, shear and friction bound along the sides in contact; returns the axes of matplotlib."""
        from .pictures import plot_contact

        return plot_contact(self, ax)

    def to_pyvista(self) -> Any:
        """The fields as an unstructured grid of PyVista; `warp_by_vector("displacement", factor=...)` deforms it."""
        import pyvista

        fields = self.fields
        kinds = [("lines", pyvista.CellType.LINE), ("triangles", pyvista.CellType.TRIANGLE), ("quads", pyvista.CellType.QUAD)]
        cells = [numpy.column_stack([numpy.full(len(fields[kind]), fields[kind].shape[1]), fields[kind]]).ravel() for kind, _ in kinds]
        types = [numpy.full(len(fields[kind]), number, numpy.uint8) for kind, number in kinds]
        points = numpy.column_stack([fields["points"], numpy.zeros(len(fields["points"]))])
        grid = pyvista.UnstructuredGrid(numpy.concatenate(cells), numpy.concatenate(types), points)
        for name, values in fields["point_data"].items():
            grid.point_data[name] = values
        for name, values in fields["cell_data"].items():
            grid.cell_data[name] = values
        grid.cell_data["part"] = numpy.concatenate([numpy.full(len(t), int(k > 0)) for k, t in enumerate(types)])
        return grid

    def save(self, path: str | os.PathLike[str], *, replace: bool = False) -> None:
        """Writes the result file of `steklov solve`, which h5py, ParaView, `steklov show` and `--resume` read.

        Needs a package that was built with HDF5: `pip install . --config-settings=build-args="--features hdf5"`.
        """
        if not hasattr(self._solved, "save"):
            raise SteklovError(
                "this package was built without HDF5: build it by "
                "pip install . --config-settings=build-args=\"--features hdf5\", or solve by the command steklov"
            )
        path = os.fspath(path)
        self._solved.save(path, replace)

    @property
    def error_bars(self) -> dict[str, tuple[float, float, list[str]]]:
        """Numbers with their error bars by their paths: value, how far the exact one may be from it, and why that is in doubt.

        J, forces of supports and obstacles, and displacement and stress at the points of `probe`, of boundary elements without random
        input and without an unbounded medium.
        """
        known = self.summary.get("quantities", {})
        return {path: (of["value"], of["uncertainty"], of["doubts"]) for path, of in known.items()}

    @property
    def energy(self) -> tuple[float, float] | None:
        """J and how far the exact one may be from it: (value, uncertainty), None without an estimate."""
        value, uncertainty = self.summary["energy_extrapolated"], self.summary["energy_uncertainty"]
        return None if value is None else (value, uncertainty)

    def __repr__(self) -> str:
        doubts = f", doubts: {', '.join(self.doubts)}" if self.doubts else ""
        return f"<steklov.Result {self.summary['title']!r}: {self.summary['dofs']} dofs, {self.summary['reason']}{doubts}>"
