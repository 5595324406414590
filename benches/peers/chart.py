"""The chart (SVG, PNG), the CSV and the summary table from the lines of runs.jsonl.

usage: chart.py FOLDER
"""

import csv
import json
import statistics
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of the backend)
from matplotlib.lines import Line2D  # noqa: E402

from problems import PROBLEMS  # noqa: E402
from settings import PEERS  # noqa: E402

LEVELS = (1e-2, 1e-3, 3e-4, 1e-5)
# a marker and a grey for each code; filled and solid, hollow and dashed, small and dotted for the families
LOOKS = {"steklov": ("o", "0.0"), "NGSolve": ("s", "0.35"), "scikit-fem": ("^", "0.5"), "GetFEM": ("D", "0.65")}
FAMILIES = {
    "adaptive": dict(linestyle="-", markersize=6),
    "told": dict(linestyle="--", markersize=6, markerfacecolor="white"),
    "uniform": dict(linestyle=":", markersize=3),
}


def series_of(record):
    """What the points of one series have in common: all but the mesh, the number of elements and the tolerance."""
    varied = ("method.tolerance",) if record["family"] == "adaptive" else ("cells", "method.elements")
    setting = {key: value for key, value in record["setting"].items() if key not in varied}
    return record["code"], record["problem"], record["family"], json.dumps(setting)


def points_of(runs):
    """Per series its solved points, seconds the median of the rounds, in the order of the work, and its failures."""
    times, failures = {}, {}
    for run in runs:
        key = series_of(run)
        if run.get("failure"):
            failures.setdefault(key, set()).add(run["failure"])
        else:
            run["error"] = PROBLEMS[run["problem"]].error(run["energy"])
            times.setdefault(key, {}).setdefault((json.dumps(run["setting"]), run["mesh"]), []).append(run)
    points = {}
    for key, groups in times.items():
        rows = [
            dict(group[0], seconds=statistics.median(r["seconds"] for r in group), repeats=len(group))
            for group in groups.values()
        ]
        rows.sort(key=lambda row: row["dofs"])
        # the error that is not exceeded from here on: energies may meet the reference by accident on their way
        worst = 0.0
        for row in reversed(rows):
            worst = max(worst, row["error"])
            row["kept"] = worst
        points[key] = rows
    return points, failures


def front(points, code, problem, family):
    """The points of a family to which none is both faster and better."""
    rows = [row for key, group in points.items() if key[:3] == (code, problem, family) for row in group]
    best = []
    for row in sorted(rows, key=lambda row: row["seconds"]):
        if not best or row["kept"] < best[-1]["kept"]:
            best.append(row)
    return best


def fastest(points, code, problem, families, level):
    """Best seconds with an error that stays below a level, None where it is not reached."""
    rows = [row for family in families for row in front(points, code, problem, family) if row["kept"] <= level]
    return min((row["seconds"] for row in rows), default=None)


def show(value):
    return "-" if value is None else f"{value:.3g}"


def line_of(name, cells):
    return f"{name:34}" + "".join(f"{cell:>10}" for cell in cells)


def table(points, problem, versions):
    """The summary of a problem for the codes in `versions`.

    Peers that are told the ends of contact have their own lines and their own ratio.
    """
    lines = ["", line_of(f"{problem}: energy error", [f"{level:.0e}" for level in LEVELS])]
    own = [fastest(points, "steklov", problem, ("adaptive", "uniform"), level) for level in LEVELS]
    lines.append(line_of("steklov, s", map(show, own)))
    for families, suffix in ((("adaptive", "uniform"), ""), (("told",), ", told the ends")):
        best = [None] * len(LEVELS)
        for code in [code for code in PEERS if code in versions]:
            values = [fastest(points, code, problem, families, level) for level in LEVELS]
            cells = map(show, values) if versions[code] else ["missing"] * len(LEVELS)
            lines.append(line_of(f"{code}{suffix}, s", cells))
            best = [min((v for v in pair if v is not None), default=None) for pair in zip(best, values)]
        ratios = [p / s if p and s else None for p, s in zip(best, own)]
        lines.append(line_of(f"best peer{suffix} / steklov", map(show, ratios)))
    return "\n".join(lines)


def name_of(key):
    """A failure's label."""
    code, _, family, setting = key
    setting = json.loads(setting)
    order = f" p={setting['order']}" if "order" in setting else ""
    return f"{code}{order} {family}"


def draw_failures(panel, failures, points):
    """A cross above the panel at the best error of each series that ended early, labels side by side."""
    across = panel.get_xaxis_transform()
    places = {key: min((row["kept"] for row in points.get(key, [])), default=panel.get_xlim()[0]) for key in failures}
    right = 0.0
    for key in sorted(failures, key=lambda key: -places[key]):
        x = panel.transAxes.inverted().transform(panel.transData.transform((places[key], 1)))[0]
        right = max(x, right + 0.02)
        panel.plot([places[key]], [1], marker="x", color="0.0", transform=across, clip_on=False)
        text = f"{name_of(key)}: {'; '.join(sorted(failures[key]))}"
        panel.text(right, 0.98, text, transform=panel.transAxes, rotation=90, va="top", ha="center", fontsize=6)


def draw(points, failures, problems, footer, versions, folder):
    """One panel a problem: seconds against the energy error."""
    figure, axes = plt.subplots(1, len(problems), figsize=(7 * len(problems), 8), squeeze=False, sharey=True)
    for panel, problem in zip(axes[0], problems):
        for code, (marker, grey) in LOOKS.items():
            rest = [row for key, group in points.items() if key[:2] == (code, problem) for row in group]
            xy = [row["kept"] for row in rest], [row["seconds"] for row in rest]
            panel.plot(*xy, marker=marker, color="0.85", linestyle="", markersize=2.5, zorder=0)
            width = 2 if code == "steklov" else 1
            for family, look in FAMILIES.items():
                best = front(points, code, problem, family)
                xy = [row["kept"] for row in best], [row["seconds"] for row in best]
                panel.plot(*xy, marker=marker, color=grey, linewidth=width, **look)
        panel.set(xscale="log", yscale="log", title=problem, xlabel="energy error (|J - Jref| / |Jref|)^(1/2)")
        panel.invert_xaxis()
        panel.grid(True, which="major", color="0.92")
        if failures:  # room for their labels
            panel.set_ylim(top=30 * max(row["seconds"] for group in points.values() for row in group))
        draw_failures(panel, {key: why for key, why in failures.items() if key[1] == problem}, points)
    axes[0][0].set_ylabel("seconds")
    legend(figure, versions)
    figure.text(0.01, 0.005, footer, fontsize=7, va="bottom")
    figure.tight_layout(rect=(0, 0.12, 1, 1))
    for kind in ("svg", "png"):
        figure.savefig(folder / f"peers.{kind}", dpi=150)


def draw_adaptive(points, problems, folder):
    """The adaptive families alone, as small as a page needs it."""
    figure, axes = plt.subplots(1, len(problems), figsize=(4.5 * len(problems), 3.8), squeeze=False, sharey=True)
    for panel, problem in zip(axes[0], problems):
        for code, (marker, grey) in LOOKS.items():
            best = front(points, code, problem, "adaptive")
            colour, width, size = (grey, 1, 4) if code in PEERS else ("tab:red", 2, 5)
            xy = [row["kept"] for row in best], [row["seconds"] for row in best]
            panel.plot(*xy, marker=marker, markersize=size, color=colour, linewidth=width, label=code)
        panel.set(xscale="log", yscale="log", title=problem, xlabel="relative error in energy norm")
        panel.invert_xaxis()
        panel.grid(True, which="major", color="0.92")
    axes[0][0].set_ylabel("seconds")
    axes[0][0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(folder / "peers-adaptive.png", dpi=100)


def legend(figure, versions):
    """One for all panels, below them, a column a code."""
    handles = []
    for code, version in versions.items():
        marker, grey = LOOKS[code]
        width = 2 if code == "steklov" else 1
        names = dict(adaptive="adaptive", told="told the ends of contact", uniform="uniform")
        if version is None:
            names = dict(adaptive="missing on this machine")
        elif code == "steklov":
            del names["told"]
        column = [
            Line2D([], [], marker=marker, color=grey, linewidth=width, label=f"{code}, {name}", **FAMILIES[family])
            for family, name in names.items()
        ]
        empty = Line2D([], [], linestyle="", label=" ")
        handles += column + [empty] * (len(FAMILIES) - len(column))
    figure.legend(handles=handles, fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 0.045), ncols=len(versions))


def main(folder):
    lines = [json.loads(line) for line in (folder / "runs.jsonl").read_text().splitlines()]
    machine, runs = lines[0], [line for line in lines if "code" in line]
    problems = list(dict.fromkeys(run["problem"] for run in runs))
    ran = {run["code"] for run in runs}
    versions = {code: version for code, version in machine["versions"].items() if code in ran or version is None}
    points, failures = points_of(runs)
    with open(folder / "peers.csv", "w", newline="") as file:
        names = ["code", "problem", "family", "setting", "mesh", "dofs", "iterations", "energy", "error", "kept"]
        names += ["seconds", "own_seconds", "repeats"]
        writer = csv.DictWriter(file, names, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(dict(row, setting=json.dumps(row["setting"])) for group in points.values() for row in group)
    load = ", ".join(f"{line['load']:.1f}" for line in lines if "load" in line)
    codes = ", ".join(f"{code} {version or 'missing'}" for code, version in versions.items())
    threads = f"threads of each code: {machine['threads']}; load of the machine before and after: {load}"
    footer = f"{machine['processor']}; {threads}\n{codes}"
    draw(points, failures, problems, footer, versions, folder)
    draw_adaptive(points, problems, folder)
    print(footer)
    for problem in problems:
        print(table(points, problem, versions))
    print()
    for key, reasons in failures.items():
        print(f"failed: {key[1]}: {name_of(key)}: {'; '.join(sorted(reasons))}")
    print(f"{folder}: peers.svg, peers.png, peers-adaptive.png, peers.csv, runs.jsonl")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
