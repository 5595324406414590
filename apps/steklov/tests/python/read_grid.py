"""Reads a result on a grid with h5py and judges it by what must hold: the fields, /multiscale, the steps, the matrices."""

import json
import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
told = json.load(open(sys.argv[2]))
text = lambda value: value.decode() if isinstance(value, bytes) else str(value)
close = lambda a, b, tol: np.testing.assert_allclose(a, b, rtol=0, atol=tol)


def labelled(name, data):
    if isinstance(data, h5py.Dataset) and not name.startswith("VTKHDF/"):
        assert len(text(data.attrs["meaning"])) > 0 and len(text(data.attrs["unit"])) > 0, name
        assert data.shape == () or len(data.attrs["axes"]) == data.ndim, name
        assert data.shape == () or data.size == 0 or data.fletcher32, name + " has no checksum"


file.visititems(labelled)
summary = json.loads(text(file["summary"][()]))
assert {key for key in told if told[key] != summary[key]} <= {"seconds"}

# The cells of the L and where their values are
at = file["multiscale"]
origin, spacing, cells, rows = (at[name][()] for name in ("origin", "spacing", "cells", "rows"))
nx, ny = cells
assert list(cells) == told["grid"]["cells"] == [16, 16] and rows.shape == (nx * ny,)
ix, iy = np.divmod(np.arange(nx * ny), ny)
centre = origin + spacing * np.column_stack([ix + 0.5, iy + 0.5])
assert np.array_equal(rows > 0, ~((centre[:, 0] > 1) & (centre[:, 1] > 1)))
vtk = file["VTKHDF"]
points, connectivity, offsets, types = (vtk[name][()] for name in ("Points", "Connectivity", "Offsets", "Types"))
lines, quads = np.flatnonzero(types == 3), np.flatnonzero(types == 9)
assert len(lines) + len(quads) == len(types) and np.all(quads >= len(lines)) and rows.max() == len(quads) == 192
corners = connectivity[offsets[quads][:, None] + np.arange(4)]
inside = rows > 0
close(points[corners[rows[inside] - 1]].mean(axis=1)[:, :2], centre[inside], 1e-14)
young = vtk["CellData/young"][()][quads]
# modulus cells of two by two fine ones
modulus = origin + (np.floor((centre - origin) / 0.25) + 0.5) * 0.25
close(young[rows[inside] - 1], 1 + modulus[inside] @ [1, 10], 1e-13)

# Stress at the centres: that of the bilinear displacement
u = vtk["PointData/displacement"][()]
assert u.shape == points.shape and np.all(u[:, 2] == 0) and np.all(points[:, 2] == 0)
hx, hy = spacing
dx, dy = np.array([-1, 1, 1, -1]) / (2 * hx), np.array([-1, -1, 1, 1]) / (2 * hy)
ux, uy = u[corners, 0], u[corners, 1]
strain = np.column_stack([ux @ dx, uy @ dy, ux @ dy + uy @ dx])
nu = at["elasticity/poisson"][0]
assert nu == 0.3 and text(at["elasticity/plane"][()]) == "strain"
unit = np.array([[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, (1 - 2 * nu) / 2]]) / ((1 + nu) * (1 - 2 * nu))
stress = vtk["CellData/stress"][()][quads]
close(young[:, None] * (strain @ unit), stress, 1e-11 * np.abs(stress).max())
xx, yy, xy = stress.T
zz = nu * (xx + yy)
mises = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2)
close(vtk["CellData/von_mises"][()][quads], mises, 1e-12 * mises.max())

# The last step and its matrix
steps = sorted(file["steps"])
assert steps == [f"{k:03}" for k in range(told["steps"])]
step = file["steps"][steps[-1]]
assert step["dofs"][0] == told["dofs"] and step["energy"][0] == told["energy"]
assert step["estimate"][0] == told["estimate"] and step["strain_energy"][0] == told["strain_energy"]
multiscale = told["model"] == "msfem"
assert ("coarse_cells" in at) == ("coarse_cells" in step) == multiscale
if multiscale:
    coarse = at["coarse_cells"][()]
    assert np.array_equal(coarse, step["coarse_cells"][()]) and coarse[:, 2:].prod(axis=1).sum() == len(quads)
    squared = step["indicators/squared"][()]
    assert squared.shape == (len(coarse),) and np.all(squared >= 0)
    close(np.sqrt(squared.sum()), told["grid"]["estimate_multiscale"], 1e-12 * told["estimate"])
    where, at_vertices = at["vertices"][()], at["vertex_displacement"][()]
    # a vertex is a point of the grid, and has its displacement
    node = np.abs(points[:, None, :2] - where[None]).max(axis=2).argmin(axis=0)
    close(points[node, :2], where, 1e-14)
    close(u[node, :2], at_vertices, 1e-13 * np.abs(u).max())
else:
    where, at_vertices = points[:, :2], u[:, :2]
name = "K_H" if multiscale else "K"
assert file[f"matrices/{name}"] == step[f"matrices/{name}"]
indptr, indices, data, shape = (step[f"matrices/{name}/{part}"][()] for part in ("indptr", "indices", "data", "shape"))
assert np.all(shape == told["dofs"]) and len(indptr) == shape[0] + 1
K = np.zeros(shape)
K[np.repeat(np.arange(shape[0]), np.diff(indptr)), indices] = data
scale = np.abs(K).max()
assert np.abs(K - K.T).max() <= 1e-13 * scale
assert shape[0] == 2 * len(where), "no vertex hangs"
x, y = where.T
one, zero = np.ones_like(x), np.zeros_like(x)
for motion in ([one, zero], [zero, one], [-y, x]):
    r = np.column_stack(motion).ravel()
    assert np.abs(K @ r).max() <= 1e-12 * scale, motion
stretch = np.column_stack([x, zero]).ravel()
assert stretch @ K @ stretch > 1
v = at_vertices.ravel()
assert abs(v @ K @ v - 2 * told["strain_energy"]) <= 1e-11 * told["strain_energy"]

# K v = f but at supports and contact, whose forces those of the solution are
f = step["matrices/f"][()]
forces = K @ v - f
on_box = (x == x.min()) | (x == x.max()) | (y == y.min()) | (y == y.max())
scale = (np.abs(K) @ np.abs(v)).max()
assert f.shape == v.shape and np.abs(forces.reshape(-1, 2)[~on_box]).max() <= 1e-12 * scale
reactions = sum(np.array(force) for force in told["reactions"].values())
close(forces.reshape(-1, 2).sum(axis=0), reactions, 1e-11 * scale)
close(f.reshape(-1, 2).sum(axis=0), -reactions, 1e-11 * scale)

# The matrix reduced to the contact nodes, in the frames of the contact: no energy but that of the others' equilibrium
S = step["matrices/S_contact"][()]
nodes = file["contact/points"][()]
assert S.shape == (2 * len(nodes), 2 * len(nodes)) and np.abs(S - S.T).max() <= 1e-12 * np.abs(S).max()
assert np.linalg.eigvalsh(S).min() > 0
