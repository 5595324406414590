"""Reads a body on a grid in an unbounded medium, by h5py and by VTK, and judges it by what must hold: the cells of both, the
fields on the interface, and the matrices, by which the stored solution is in equilibrium."""

import json
import sys

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

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

# Cells: lines, triangles of the medium, quadrilaterals of the body
vtk = file["VTKHDF"]
points, connectivity, offsets, types = (vtk[name][()] for name in ("Points", "Connectivity", "Offsets", "Types"))
LINE, TRIANGLE, QUAD = 3, 5, 9
assert np.all(np.diff(types.astype(int)) >= 0) and set(types) == {LINE, TRIANGLE, QUAD}
region, young = vtk["CellData/region"][()], vtk["CellData/young"][()]
assert np.array_equal(region, types == TRIANGLE), "0 body, 1 medium around it"
assert set(young[types == QUAD]) == {10} and set(young[types == TRIANGLE]) == {2}
first = 9 * 9  # points of the medium follow the nodes of the grid
assert (types == QUAD).sum() == 64 and np.abs(points[:first]).max() == 0.5
triangles = connectivity[offsets[np.flatnonzero(types == TRIANGLE)][:, None] + np.arange(3)]
assert triangles.min() >= first
a, b, c = (points[triangles[:, i], :2] for i in range(3))
area = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
side = 1 + 2 * np.sqrt(2)
assert np.all(area > 0) and abs(area.sum() - (side**2 - 1)) < 1e-12 * side**2
u = vtk["PointData/displacement"][()]
assert u.shape == points.shape and np.all(u[:, 2] == 0) and np.isfinite(u).all()

# VTK opens the same cells and fields
reader = vtkHDFReader()
assert reader.CanReadFile(sys.argv[1])
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutputDataObject(0)
assert np.array_equal([grid.GetCellType(i) for i in range(grid.GetNumberOfCells())], types)
for data, group in ((grid.GetPointData(), "PointData"), (grid.GetCellData(), "CellData")):
    arrays = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
    for name in vtk[group]:
        assert np.array_equal(arrays[name], vtk[group][name][()]), name

# /coupling: the window is the medium of the fields
at = file["coupling"]
window = at["exterior"]
assert np.array_equal(window["points"][()], points[first:, :2])
assert np.array_equal(window["displacement"][()], u[first:, :2])
assert np.array_equal(window["triangles"][()] + first, triangles)
mean = window["stress"][()][triangles - first].mean(axis=1)
close(mean, vtk["CellData/stress"][()][types == TRIANGLE], 1e-14 * np.abs(mean).max())
for name in ("constant", "resultant"):
    assert list(at[name][()]) == told["exterior"][name]
assert at["length"][0] == told["exterior"]["length"] and told["exterior"]["balanced"]
remote = at["remote_stress"][()]
assert list(remote) == [1, -0.5, 0.25]
assert at["material/young"][0] == 2 and text(at["material/plane"][()]) == "strain"
nodes, xi, phi = (at[name][()] for name in ("points", "displacement", "traction"))
assert np.array_equal(at["mesh/nodes"][()], nodes), "degree 1"
n = 2 * len(nodes)

# The last step: residuals of each boundary element
step = file["steps/000"]
terms = step["interface"]
assert set(terms) == {"traction", "displacement", "traction_error"}
assert all(terms[name].shape == (len(nodes),) and np.all(terms[name][()] >= 0) for name in terms)
assert told["grid"]["boundary_elements"] == len(nodes)
close(np.sqrt(terms["traction_error"][()].sum()), told["grid"]["estimate_medium"], 1e-12)


def dense(group):
    indptr, indices, data, shape = (group[part][()] for part in ("indptr", "indices", "data", "shape"))
    matrix = np.zeros(shape)
    matrix[np.repeat(np.arange(shape[0]), np.diff(indptr)), indices] = data
    return matrix


# Matrices of the medium
matrices = step["matrices"]
assert file["matrices"] == matrices
V, K, W = (matrices["medium"][name][()] for name in "VKW")
M = dense(matrices["medium/M"])
assert all(a.shape == (n, n) for a in (V, K, W, M)) and np.linalg.eigvalsh(V).min() > 0


def motions(x, y):
    one, zero = np.ones_like(x), np.zeros_like(x)
    return [np.column_stack(r).ravel() for r in ([one, zero], [zero, one], [-y, x])]


for r in motions(*nodes.T):
    for a in (W, K + M / 2):
        assert np.abs(a @ r).max() <= 1e-12 * (np.abs(a) @ np.abs(r)).max()

# The stiffness of the body, and reduced to its trace
body = dense(matrices["K_H" if told["model"] == "msfem-bem" else "K"])
trace, transfer, A = matrices["trace"], matrices["transfer"], matrices["A_interface"][()]
unknowns, where = trace["unknowns"][()], trace["points"][()]
m = len(unknowns)
assert np.array_equal(dense(trace["values"]), np.eye(m)) and m == 2 * len(where) and A.shape == (m, m)
others = np.setdiff1d(np.arange(len(body)), unknowns)
assert len(body) == told["dofs"] and len(others) > 0
inside = body[np.ix_(others, others)]
coupling = body[np.ix_(others, unknowns)]
reduced = body[np.ix_(unknowns, unknowns)] - coupling.T @ np.linalg.solve(inside, coupling)
close(A, reduced, 1e-12 * np.abs(A).max())
for r in motions(*where.T):
    assert np.abs(A @ r).max() <= 1e-12 * np.abs(A).max()
spectrum = np.linalg.eigvalsh(A)
assert spectrum[3] > 1e-3 * spectrum[-1], "three rigid motions and no more"
projection, mass = dense(transfer["projection"]), dense(transfer["mass"])
assert projection.shape == mass.shape == (n, m)

# u - u_c - u_remote = jump at the nodes of the boundary elements
node = np.abs(points[:first, None, :2] - where[None]).max(axis=2).argmin(axis=0)
close(points[node, :2], where, 1e-15)
v = u[node, :2].ravel()
E, nu = 2.0, 0.3
mu = E / (2 * (1 + nu))
xx, yy, xy = remote
strain = np.array([[(1 - nu) * xx - nu * yy, xy], [xy, (1 - nu) * yy - nu * xx]]) / (2 * mu)
jump = nodes * [-0.01, 0.02] + nodes @ strain
scale = np.abs(v).max()
close((projection @ v).reshape(-1, 2) - xi, jump, 1e-13 * scale)
# and the moments of the trace against tractions are those of the boundary elements
close(mass, M @ projection, 1e-14)

# Equations of the medium, equilibrium of body and medium under the tractions of the remote stress
xi, phi = xi.ravel(), phi.ravel()
double = K - M / 2
close(V @ phi, double @ xi, 1e-12 * np.abs(double @ xi).max())
sides = np.roll(where, -1, axis=0) - where
loads = (np.column_stack([sides[:, 1], -sides[:, 0]]) @ [[xx, xy], [xy, yy]]) / 2
force = (loads + np.roll(loads, 1, axis=0)).ravel()
left = A @ v + projection.T @ (W @ xi + double.T @ phi)
close(left, force, 1e-11 * np.abs(force).max())
assert np.abs(A @ v - force).max() > 0.1 * np.abs(force).max(), "the medium takes a part"
