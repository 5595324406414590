"""Plates with circular holes in tension beside NGSolve with curved triangles: energy error and processor seconds of one thread.

usage: plate.py COMMAND FOLDER [--quick]
"""

import csv
import json
import resource
import subprocess
import sys
import time
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import matplotlib.ticker
import ngsolve as ng
from netgen.geom2d import CSG2d, Circle, Rectangle
from ngsolve import Grad, InnerProduct, ds, dx

YOUNG, POISSON, RADIUS = 1.0, 0.3, 0.3
PLATES = {(5, 4): [8e-3, 1e-3, 1e-4, 4e-5, 4e-6, 4e-7], (10, 8): [8e-3, 4e-4, 4e-5, 1e-5]}
MESHES = [(0.6, 3), (0.6, 4), (0.5, 5), (0.4, 6), (0.3, 8), (0.2, 8), (0.2, 10), (0.2, 11)]
REFERENCE = (0.2, 12)
# the fastest of so many runs counts
REPEAT = 3


def steklov(command, folder, plate, tolerance):
    """Unknowns, J and processor seconds of the whole process."""
    nx, ny = plate
    text = f'[body]\ncorners = [[0, 0], [{nx}, 0], [{nx}, {ny}], [0, {ny}]]\nsides = ["b", "r", "t", "l"]\n'
    for i in range(nx):
        for j in range(ny):
            text += f'[[body.holes]]\ncircle = {{ centre = [{i + 0.5}, {j + 0.5}], radius = {RADIUS} }}\nside = "h"\n'
    text += f"[material]\nyoung = {YOUNG}\npoisson = {POISSON}\n"
    text += '[sides.r]\ntraction = ["1", "0"]\n[sides.l]\ntraction = ["-1", "0"]\n'
    text += f"[method]\nmax_dofs = 20000\ntolerance = {tolerance}\n"
    scene = folder / "plate.toml"
    scene.write_text(text)
    used = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
    start = used()
    done = subprocess.run(
        [command, "solve", scene, "--out", folder / "plate.vtkhdf", "--force", "--json", "--quiet", "--threads", "1"],
        capture_output=True,
        text=True,
    )
    seconds = used() - start
    told = json.loads(done.stdout)
    return told["dofs"], told["energy"], seconds, told["peak_memory_bytes"] / 1e9


def ngsolve(plate, size, order):
    """The same of one mesh of curved triangles, condensed, by a sparse Cholesky factorisation."""
    nx, ny = plate
    start = time.process_time()
    geometry = CSG2d()
    body = Rectangle(pmin=(0, 0), pmax=(nx, ny), left="l", right="r")
    for i in range(nx):
        for j in range(ny):
            body -= Circle(center=(i + 0.5, j + 0.5), radius=RADIUS)
    geometry.Add(body)
    mesh = ng.Mesh(geometry.GenerateMesh(maxh=size))
    mesh.Curve(order)
    space = ng.VectorH1(mesh, order=order)
    u, v = space.TnT()
    lam = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    mu = YOUNG / (2 * (1 + POISSON))
    strain = lambda w: 0.5 * (Grad(w) + Grad(w).trans)
    with ng.TaskManager():
        form = ng.BilinearForm(space, symmetric=True, condense=True)
        form += (lam * ng.Trace(strain(u)) * ng.Trace(strain(v)) + 2 * mu * InnerProduct(strain(u), strain(v))) * dx
        load = ng.LinearForm(v[0] * ds("r") - v[0] * ds("l"))
        form.Assemble()
        load.Assemble()
        # two corners hold the rigid motions, which nothing loads
        free = ng.BitArray(space.FreeDofs(True))
        for corner, component in (((0, 0), 0), ((0, 0), 1), ((nx, 0), 1)):
            vertex = next(k for k in mesh.vertices if k.point == tuple(map(float, corner)))
            free.Clear(space.components[component].GetDofNrs(ng.NodeId(ng.VERTEX, vertex.nr))[0] + component * space.components[0].ndof)
        solution = ng.GridFunction(space)
        f = load.vec
        f.data += form.harmonic_extension_trans * f
        solution.vec.data = form.mat.Inverse(free, "sparsecholesky") * f
        solution.vec.data += form.harmonic_extension * solution.vec
        solution.vec.data += form.inner_solve * f
        seconds = time.process_time() - start
        # the load works along straight sides: degree p against a constant
        pull = solution[0] * ng.IfPos(ng.x - nx / 2, 1, -1)
        work = ng.Integrate(pull, mesh, ng.BND, order=order, definedon=mesh.Boundaries("l|r"))
    return space.ndof, -0.5 * work, seconds, float("nan")


def main():
    command, folder, quick = sys.argv[1], Path(sys.argv[2]), "--quick" in sys.argv
    ng.SetNumThreads(1)
    rows = []
    for plate, tolerances in PLATES.items():
        if quick and plate != (5, 4):
            continue
        name = f"{plate[0]} x {plate[1]} circles"
        fastest = lambda solve: min((solve() for _ in range(REPEAT)), key=lambda run: run[2])
        runs = [("steklov", f"tolerance {t:g}", *fastest(lambda: steklov(command, folder, plate, t))) for t in tolerances]
        runs += [("NGSolve", f"h {h}, degree {p}", *fastest(lambda: ngsolve(plate, h, p))) for h, p in MESHES]
        # the two codes judge each other
        finest = {"NGSolve": runs[len(tolerances) - 1][3], "steklov": ngsolve(plate, *REFERENCE)[1]}
        print(f"{name}: J {finest['NGSolve']:.13f} (steklov), {finest['steklov']:.13f} (NGSolve)")
        for code, setting, dofs, energy, seconds, memory in runs:
            error = abs(energy / finest[code] - 1) ** 0.5
            rows.append([name, code, setting, dofs, energy, error, seconds, memory])
            print(f"  {code:8} {setting:18} {dofs:7} unknowns, energy error {error:.1e}, {seconds:.2f} s", flush=True)
    with open(folder / "plate.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["plate", "code", "setting", "dofs", "energy", "energy_error", "processor_seconds", "gigabytes"])
        writer.writerows(rows)
    draw(rows, folder)


def draw(rows, folder):
    """Energy error over processor seconds, a panel a plate."""
    plates = list(dict.fromkeys(row[0] for row in rows))
    figure, panels = plt.subplots(1, len(plates), figsize=(5 * len(plates), 4.2), sharey=True, layout="constrained", squeeze=False)
    for panel, plate in zip(panels[0], plates):
        for code, mark in (("steklov", "o-"), ("NGSolve", "s--")):
            own = [(row[6], row[5]) for row in rows if row[0] == plate and row[1] == code]
            panel.loglog(*zip(*own), mark, label=code)
        panel.set(title=plate, xlabel="processor seconds, one thread")
        panel.xaxis.set_minor_formatter(matplotlib.ticker.LogFormatter(minor_thresholds=(2, 0.5)))
        panel.grid(True, which="both", alpha=0.3)
    panels[0][0].set_ylabel("energy error")
    panels[0][0].legend()
    for end in ("svg", "png"):
        figure.savefig(folder / f"plate.{end}", dpi=150)


if __name__ == "__main__":
    main()
