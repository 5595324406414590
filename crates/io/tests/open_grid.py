"""Opens a grid with VTK and compares its extents with the file's own."""

import sys

import h5py
from vtkmodules.vtkIOHDF import vtkHDFReader

with h5py.File(sys.argv[1]) as file:
    points, cells = file["VTKHDF/NumberOfPoints"][0], file["VTKHDF/NumberOfCells"][0]
reader = vtkHDFReader()
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutputDataObject(0)
assert grid is not None, "VTK gives no grid"
assert (grid.GetNumberOfPoints(), grid.GetNumberOfCells()) == (points, cells)
