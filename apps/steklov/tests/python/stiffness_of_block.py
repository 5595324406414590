"""S of a square block of side 1, E = 200, nu = 0.3: what it resists and what not, and the energy of a uniform strain."""

import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
points, S = file["solution/points"][()], file["matrices/S"][()]
n = 2 * len(points)
for name in "VKWS":
    data = file["matrices"][name]
    axes = [axis.decode() if isinstance(axis, bytes) else axis for axis in data.attrs["axes"]]
    assert data.shape == (n, n) and data.dtype == np.float64 and data.fletcher32, name
    assert len(axes) == 2 and all("component fastest" in axis for axis in axes), (name, axes)
# three rigid motions and no more
spectrum = np.linalg.eigvalsh(S)
assert np.all(np.abs(spectrum[:3]) < 1e-12 * spectrum[-1]) and spectrum[3] > 1e-6 * spectrum[-1], spectrum[:4]
# u = (x, 0): the energy of the uniform strain, E (1-nu) / ((1+nu)(1-2nu)) times the area 1
stretch = np.column_stack([points[:, 0], np.zeros(len(points))]).ravel()
assert abs(stretch @ S @ stretch - 200 * 0.7 / (1.3 * 0.4)) < 1e-9
# the same matrices lie under their step, nothing else was asked for
assert file["steps/001/matrices/S"] == file["matrices/S"] and file["steps/000/matrices/S"].shape == (n // 2, n // 2)
assert "contact_problem" not in file and "contact_problem" not in file["steps/001"]
