"""Reads the file of tests/python.rs with h5py and VTK and compares it with the formulas that made it."""

import sys

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

path = sys.argv[1]
with h5py.File(path) as file:
    assert file.attrs["format"].decode() == "steklov", file.attrs["format"]
    assert file.attrs["format_version"] == 1
    assert file.attrs["program_version"].decode() == "0.1.0"
    assert file.attrs["threads"] == 2
    scene = file["scene"].asstr()[()]
    assert type(scene) is str and scene == 'title = "Größe λ"\n', scene

    things = file["things"]
    vector = things["vector"]
    assert vector.dtype == "<f8" and np.array_equal(vector[:], np.sqrt(np.arange(200_000.0)))
    assert vector.attrs["unit"].decode() == "stress"
    assert vector.attrs["meaning"].decode() == "pressure λ_n ≥ 0"
    assert [axis.decode() for axis in vector.attrs["axes"]] == ["node"]
    assert things["empty"].shape == (0,)
    points = things["points"]
    assert np.array_equal(points[:], [[0.5, 1.5], [2.5, -3.5], [4.5, np.inf]])
    assert [axis.decode() for axis in points.attrs["axes"]] == ["node", "xy"]
    assert things["integers"].dtype == "<i8" and list(things["integers"]) == [3, 1, 4, 1, 5]
    assert list(things["names"].asstr()[:]) == ["floor", "türe", ""]
    dense = things["dense"]
    assert np.array_equal(dense[:], [[10 * i + j for j in range(3)] for i in range(4)])
    assert dense[3, 1] == 31.0
    assert things["no_rows"].shape == (0, 3)

    # The arrays are those of scipy.sparse.csr_matrix((data, indices, indptr), shape).
    parts = {name: things["sparse"][name][:] for name in ("shape", "indptr", "indices", "data")}
    full = np.zeros(parts["shape"])
    for row in range(5):
        for k in range(parts["indptr"][row], parts["indptr"][row + 1]):
            full[row, parts["indices"][k]] = parts["data"][k]
    wanted = [[1 / (1 + i + 10 * j) if i != 1 and (3 * i + 5 * j) % 7 < 3 else 0 for j in range(4)] for i in range(5)]
    assert np.array_equal(full, wanted)

    def labelled(name, thing):
        if isinstance(thing, h5py.Dataset):
            assert {"unit", "meaning"} <= set(thing.attrs), name
            assert len(thing.attrs.get("axes", [])) == thing.ndim, name
            assert thing.fletcher32 or thing.size == 0 or "fnv1a" in thing.attrs, name

    file.visititems(labelled)

reader = vtkHDFReader()
assert reader.CanReadFile(path)
reader.SetFileName(path)
reader.Update()
grid = reader.GetOutputDataObject(0)
assert grid.GetClassName() == "vtkUnstructuredGrid"
points = vtk_to_numpy(grid.GetPoints().GetData())
assert np.array_equal(points, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]])
cells = [[grid.GetCell(c).GetPointId(k) for k in range(grid.GetCell(c).GetNumberOfPoints())] for c in range(7)]
assert cells == [[0, 1], [1, 2], [2, 3], [3, 0], [0, 1, 2], [0, 2, 3], [1, 4, 5, 2]], cells
assert [grid.GetCellType(c) for c in range(7)] == [3, 3, 3, 3, 5, 5, 9]
displacement = vtk_to_numpy(grid.GetPointData().GetArray("displacement"))
assert np.array_equal(displacement, np.arange(18.0).reshape(6, 3) / 8)
assert np.array_equal(vtk_to_numpy(grid.GetPointData().GetArray("temperature")), np.arange(6.0) / 8)
assert list(vtk_to_numpy(grid.GetCellData().GetArray("part"))) == [0, 0, 0, 0, 1, 1, 1]
assert np.array_equal(vtk_to_numpy(grid.GetCellData().GetArray("von Mises")), np.arange(7.0) / 8)
