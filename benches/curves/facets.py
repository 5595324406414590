"""What polygons cost that stand for curves: errors by straight sides and by the curves themselves.

usage: facets.py COMMAND FOLDER
"""

import csv
import json
import math
import subprocess
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

TOLERANCES = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6]
SIDES = [16, 32, 64, 128]


def solve(command, folder, text, tolerance):
    """The JSON object of a scene."""
    scene = folder / "scene.toml"
    scene.write_text(text)
    done = subprocess.run(
        [command, "solve", scene, "--out", folder / "scene.vtkhdf", "--force", "--json", "--quiet"]
        + ["--set", f"method.tolerance={tolerance}", "--set", "method.max_dofs=3000"],
        capture_output=True,
        text=True,
    )
    if not done.stdout:
        sys.exit(f"facets: {done.stderr}")
    return json.loads(done.stdout)


def quarter(a, b, sides, turn):
    """Corners of an elliptic quarter, without its last one."""
    angles = [math.pi / 2 * k / sides for k in range(sides + 1)]
    corners = [[a * math.cos(t), b * math.sin(t)] for t in angles]
    return corners[::-1] if turn else corners


def circle(sides):
    """Kirsch's hole by a regular polygon, probed in the middle of an edge, or by the circle."""
    if sides is None:
        body, top = 'circle = { centre = [0, 0], radius = 1 }\nside = "hole"', 1.0
    else:
        angles = [2 * math.pi * (k + 0.5) / sides for k in range(sides)]
        corners = [[math.cos(t), math.sin(t)] for t in angles]
        body = f"corners = {corners}\nsides = {['hole'] * sides}".replace("'", '"')
        top = math.cos(math.pi / sides)
    far = "[exterior]\nyoung = 1\npoisson = 0.3\nremote_stress = [1, 0, 0]\n"
    return f"[body]\n{body}\n{far}[probe]\npoints = [[0, {top}]]\n"


def membrane(sides):
    """NAFEMS LE1 by polygons or by the ellipses."""
    if sides is None:
        body = (
            'corners = [[2, 0], [3.25, 0], [0, 2.75], [0, 1]]\nsides = ["y0", "outer", "x0", "inner"]\n'
            "arcs = { outer = { centre = [0, 0], radii = [3.25, 2.75] }, inner = { centre = [0, 0], radii = [2, 1] } }"
        )
    else:
        inner, outer = quarter(2, 1, sides, True), quarter(3.25, 2.75, sides, False)
        names = ["outer"] * sides + ["x0"] + ["inner"] * sides + ["y0"]
        body = f"corners = {outer + inner}\nsides = {names}".replace("'", '"')
    return (
        f'[body]\n{body}\n[material]\nyoung = 210e3\npoisson = 0.3\nplane = "stress"\n'
        '[sides.y0]\ndisplacement = ["free", "0"]\n[sides.x0]\ndisplacement = ["0", "free"]\n'
        '[sides.outer]\npressure = "-10"\n'
    )


# name, scene, what is told, and its value
CASES = [
    ("hoop stress of a circle (Kirsch)", circle, lambda told: told["probe"][0]["stress"][0], 3.0),
    # the stress at (2, 0) of a polygon is infinite, which is told in place of a number
    ("strain energy between ellipses (NAFEMS LE1)", membrane, lambda told: told["strain_energy"], 6.0837359652981e-3),
]


def main():
    command, folder = sys.argv[1], Path(sys.argv[2])
    rows = []
    for name, scene, value_of, value in CASES:
        for sides in [None, *SIDES]:
            for tolerance in TOLERANCES:
                told = solve(command, folder, scene(sides), tolerance)
                error = abs(value_of(told) / value - 1)
                rows.append([name, sides or "curves", tolerance, told["dofs"], told["seconds"]["total"], error])
                print("{}, {}: tolerance {:g}, {} unknowns, {:.3f} s, error {:.1e}".format(*rows[-1]), flush=True)
                if told["reason"] != "tolerance":
                    break
    with open(folder / "facets.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["case", "sides", "tolerance", "dofs", "seconds", "error"])
        writer.writerows(rows)
    draw(rows, folder)


def draw(rows, folder):
    """One row of panels a case: error over unknowns and over seconds."""
    figure, panels = plt.subplots(len(CASES), 2, figsize=(10, 8), sharey="row", layout="constrained")
    for panels, (name, *_) in zip(panels, CASES):
        for sides in ["curves", *SIDES]:
            line = [r for r in rows if r[0] == name and r[1] == sides]
            style = dict(marker="o", lw=2.5, color="black") if sides == "curves" else dict(marker=".", lw=1)
            label = "the curve itself" if sides == "curves" else f"{sides} sides" + (" a quarter" if "LE1" in name else "")
            for panel, column in zip(panels, (3, 4)):
                panel.loglog([r[column] for r in line], [max(r[5], 1e-12) for r in line], label=label, **style)
        panels[0].set(xlabel="unknowns", ylabel="relative error", title=name)
        panels[1].set(xlabel="seconds", title=name)
        panels[0].legend(frameon=False)
        for panel in panels:
            panel.grid(alpha=0.3)
    for end in ("svg", "png"):
        figure.savefig(folder / f"facets.{end}", dpi=150)


if __name__ == "__main__":
    main()
