"""Pictures of results by matplotlib."""

import numpy

from . import _steklov
from .errors import near

STRESSES = {"xx": 0, "yy": 1, "xy": 2}
FIELDS = ("von_mises", "xx", "yy", "xy", "displacement", "ux", "uy", "young", "poisson")


def values_of(grid, field):
    """Points, displacements, triangles and values at the points, of cells with points of their own."""
    of_points, of_cells = grid["point_data"], grid["cell_data"]
    name, component = ("stress", STRESSES[field]) if field in STRESSES else (field, None)
    if field in ("ux", "uy"):
        name, component = "displacement", "xy".index(field[1])
    values = {**of_cells, **of_points}.get(name)
    if values is None:
        known = [known for known in FIELDS if {**of_cells, **of_points}.get("stress" if known in STRESSES else known[:1] == "u" and "displacement" or known) is not None]
        raise KeyError(f"{field!r} is no field of this result{near(field, known)}; it has {', '.join(known)}")
    if component is not None:
        values = values[:, component]
    elif values.ndim > 1:
        values = numpy.linalg.norm(values, axis=1)
    points, displacement, triangles, quads = grid["points"], of_points["displacement"], grid["triangles"], grid["quads"]
    if len(quads) == 0 and name in of_points:
        return points, displacement, triangles, values
    # the quadrilaterals in two triangles each, and every cell with its own points
    corners = [triangles, quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
    cells = numpy.concatenate(corners)
    if name in of_points:
        return points, displacement, cells, values
    of_triangles, of_quads = numpy.split(values[len(grid["lines"]) :], [len(triangles)])
    own = numpy.concatenate([of_triangles, of_quads, of_quads])
    return points[cells].reshape(-1, 2), displacement[cells].reshape(-1, displacement.shape[1]), numpy.arange(3 * len(cells)).reshape(-1, 3), numpy.repeat(own, 3)


def unit_of(result, name):
    """The unit of a field, in brackets."""
    units = result.summary.get("units", {})
    length, stress = units.get("length"), units.get("stress")
    unit = {"displacement": length, "ux": length, "uy": length, "poisson": None}.get(name, stress)
    return f" in {unit}" if unit else ""


LABELS = {
    "von_mises": "von Mises stress",
    "xx": "stress σ_xx",
    "yy": "stress σ_yy",
    "xy": "stress σ_xy",
    "displacement": "|u|",
    "ux": "u_x",
    "uy": "u_y",
    "young": "Young's modulus",
    "poisson": "Poisson's ratio",
}


def plot(result, field, ax, enlarge):
    """Draws the deformed body, coloured by a field."""
    import matplotlib.pyplot as pyplot
    from matplotlib.collections import LineCollection
    from matplotlib.tri import Triangulation

    grid = result.fields
    points, displacement, triangles, values = values_of(grid, field)
    moved = grid["point_data"]["displacement"][:, :2]
    factor = grid["enlargement"] if enlarge is None else float(enlarge)
    if not numpy.isfinite(factor):
        raise ValueError(f"displacements cannot be enlarged by {factor}: give a finite number")
    at = points + factor * displacement[:, :2]
    ax = pyplot.subplots(figsize=(8, 6), layout="constrained")[1] if ax is None else ax
    low, high = _steklov.colour_interval(numpy.ascontiguousarray(points), numpy.ascontiguousarray(triangles), numpy.abs(values))
    if numpy.nanmin(values) < 0:
        low, high = max(-high, numpy.nanmin(values)), min(high, max(numpy.nanmax(values), 0.0))
    known = numpy.isfinite(values)[triangles].all(axis=1)
    drawn = ax.tripcolor(Triangulation(*at.T, triangles[known]), values, shading="gouraud", vmin=low, vmax=high, rasterized=True)
    lines, outline = grid["lines"], grid["points"] + factor * moved
    ax.add_collection(LineCollection(grid["points"][lines], colors="0.7", linewidths=0.6))
    ax.add_collection(LineCollection(outline[lines], colors="black", linewidths=0.8))
    beyond = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    extend = beyond[bool(numpy.nanmin(values) < low), bool(numpy.nanmax(values) > high)]
    ax.figure.colorbar(drawn, ax=ax, label=LABELS[field] + unit_of(result, field), extend=extend, shrink=0.8)
    length = result.summary.get("units", {}).get("length")
    suffix = f" in {length}" if length else ""
    ax.set(aspect="equal", xlabel="x" + suffix, ylabel="y" + suffix, title=f"{result.summary['title']}\ndisplacement times {factor:g}")
    return ax


def plot_contact(result, ax):
    """Draws pressure, shear and friction bound along the sides in contact."""
    import matplotlib.pyplot as pyplot

    table = result.contact
    sides = list(dict.fromkeys(table["side"]))
    if not sides:
        raise ValueError("nothing of this scene is in contact")
    ax = pyplot.subplots(figsize=(8, 4), layout="constrained")[1] if ax is None else ax
    rubs = bool(numpy.any(table["bound"] != 0) or numpy.any(table["shear"] != 0))
    for k, side in enumerate(sides):
        rows = numpy.array([name == side for name in table["side"]])
        s = numpy.concatenate([[0], numpy.cumsum(numpy.linalg.norm(numpy.diff(table["point"][rows], axis=0), axis=1))])
        ax.plot(s, table["pressure"][rows], ".-", color=f"C{k}", label=f"pressure on {side}")
        if rubs:
            ax.plot(s, table["shear"][rows], ".--", color=f"C{k}", label=f"shear on {side}")
            ax.fill_between(s, -table["bound"][rows], table["bound"][rows], color=f"C{k}", alpha=0.15, lw=0, label="friction bound")
    length = result.summary.get("units", {}).get("length")
    ax.set(xlabel="distance along the side" + (f" in {length}" if length else ""), ylabel="stress" + unit_of(result, "xx"), title=result.summary["title"])
    ax.axhline(0, color="black", lw=0.6)
    ax.legend()
    return ax


def plot_sweep(sweep, path, key, ax):
    """Draws a number of the points of a sweep over a varied key: a curve for each combination of the others."""
    import matplotlib.pyplot as pyplot

    key = sweep.keys[0] if key is None else key
    if key not in sweep.keys:
        raise KeyError(f"{key!r} is not varied{near(key, sweep.keys)}")
    x, y = sweep[key], sweep[path]
    if x.dtype.kind not in "iuf":
        raise ValueError(f"the values of {key} are no numbers: draw over another key, or take frame()")
    band = sweep["energy_uncertainty"] if path == "energy_extrapolated" else None
    ax = pyplot.subplots(figsize=(7, 4.5), layout="constrained")[1] if ax is None else ax
    others = [k for k, name in enumerate(sweep.keys) if name != key]
    groups = {}
    for k, point in enumerate(sweep.points):
        groups.setdefault(tuple(str(point[o]) for o in others), []).append(k)
    for values, rows in groups.items():
        rows = numpy.array(rows)
        rows = rows[numpy.argsort(x[rows], kind="stable")]
        label = ", ".join(f"{sweep.keys[o]} = {value}" for o, value in zip(others, values))
        (line,) = ax.plot(x[rows], y[rows], ".-", label=label or None)
        if band is not None:
            ax.fill_between(x[rows], y[rows] - band[rows], y[rows] + band[rows], color=line.get_color(), alpha=0.25, lw=0)
        # what has not reached its aim, or is in doubt, is hollow
        weak = numpy.array([not sweep.converged[k] or bool(sweep.summaries[k]["estimate_doubts"]) for k in rows])
        ax.plot(x[rows][weak], y[rows][weak], "o", mfc="white", color=line.get_color())
    if others:
        ax.legend()
    ax.set(xlabel=key, ylabel=path)
    return ax
