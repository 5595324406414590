"""VTK's own reader on a result of scenes/block-on-floor.toml: points, cells, part, displacement, stress, von Mises."""

import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

reader = vtkHDFReader()
assert reader.CanReadFile(sys.argv[1])
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutputDataObject(0)
assert grid.GetClassName() == "vtkUnstructuredGrid"
points = vtk_to_numpy(grid.GetPoints().GetData())
assert len(points) > 100 and np.abs(points[:, :2]).max() == 0.5 and np.all(points[:, 2] == 0)
kinds = np.array([grid.GetCellType(i) for i in range(grid.GetNumberOfCells())])
cells = [[grid.GetCell(i).GetPointId(j) for j in range(grid.GetCell(i).GetNumberOfPoints())] for i in range(len(kinds))]
LINE, TRIANGLE = 3, 5
part = vtk_to_numpy(grid.GetCellData().GetArray("part"))
assert np.array_equal(kinds, np.where(part == 0, LINE, TRIANGLE)) and set(part) == {0, 1}
# Lines: the whole boundary once. Triangles: the whole body once.
along = np.array([points[b] - points[a] for a, b in (c for c, k in zip(cells, kinds) if k == LINE)])
assert abs(np.hypot(along[:, 0], along[:, 1]).sum() - 4) < 1e-13
triangles = np.array([c for c, k in zip(cells, kinds) if k == TRIANGLE])
a, b, c = (points[triangles[:, i]] for i in range(3))
area = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
assert np.all(area > 0) and abs(area.sum() - 1) < 1e-13

data = grid.GetPointData()
arrays = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
u, stress, von_mises = arrays["displacement"], arrays["stress"], arrays["von_mises"]
n = len(points)
assert (u.shape, stress.shape, von_mises.shape) == ((n, 3), (n, 3), (n,))
assert all(np.isfinite(v).all() for v in arrays.values()) and np.all(u[:, 2] == 0)
# verification.md: displacement at (-1/2, -1/2); the scene is symmetric in x
at = lambda x: np.flatnonzero((points[:, :2] == x).all(axis=1))[0]
np.testing.assert_allclose(u[at([-0.5, -0.5]), :2], [0.05067434, 0.01137091], atol=5e-5)
np.testing.assert_allclose(u[at([0.5, -0.5]), :2], [-0.05067434, 0.01137091], atol=5e-5)
# von Mises in plane strain, σ_zz = ν (σ_xx + σ_yy)
xx, yy, xy = stress.T
zz = 0.3 * (xx + yy)
wanted = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2)
np.testing.assert_allclose(von_mises, wanted, rtol=1e-12, atol=1e-12)
# Strain of each triangle by its corners against its stress there by Hooke's law: a sane field, up to the triangles' size
E, nu = 200.0, 0.3
inside = np.abs((a + b + c) / 3).max(axis=1) < 0.4
d = lambda i, j: (u[triangles[:, j], i] - u[triangles[:, 0], i])
det = 2 * area
dx = lambda i: (d(i, 1) * (c - a)[:, 1] - d(i, 2) * (b - a)[:, 1]) / det
dy = lambda i: (d(i, 2) * (b - a)[:, 0] - d(i, 1) * (c - a)[:, 0]) / det
lame, shear = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
trace = dx(0) + dy(1)
made = np.column_stack([lame * trace + 2 * shear * dx(0), lame * trace + 2 * shear * dy(1), shear * (dy(0) + dx(1))])
mean = stress[triangles].mean(axis=1)
error = np.abs(made - mean)[inside].max(axis=1)
# stresses of a load on a side of length 1 vary over lengths of that order
longest = np.max([np.hypot(*(p - q)[:, :2].T) for p, q in ((a, b), (b, c), (c, a))], axis=0)[inside]
assert inside.sum() > 100 and np.all(error < 3 * longest * np.abs(stress).max()), (error / longest).max()
