"""The matrices of --save matrices: shapes, symmetry, rigid motions, and S from the others."""

import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
at = file["matrices"]
text = lambda value: value.decode() if isinstance(value, bytes) else str(value)
points, degree = file["solution/points"][()], file["mesh/degree"][()]
n = 2 * len(points)
full = {name: at[name][()] for name in "VKWS"}
for name, a in full.items():
    assert a.shape == (n, n) and a.dtype == np.float64 and np.isfinite(a).all(), name
    data = at[name]
    for key in ("unit", "meaning", "axes"):
        assert len(data.attrs[key]) > 0, (name, key)
    assert data.fletcher32, name
    axes = [text(axis) for axis in data.attrs["axes"]]
    assert len(axes) == 2 and all("component fastest" in axis for axis in axes), (name, axes)
V, K, W, S = (full[name] for name in "VKWS")
assert "Legendre" in text(at["V"].attrs["axes"][0]) and "Legendre" in text(at["K"].attrs["axes"][0])

# The mass matrix, dense or in scipy's CSR
if isinstance(at["M"], h5py.Group):
    indptr, indices, data, shape = (at["M"][key][()] for key in ("indptr", "indices", "data", "shape"))
    M = np.zeros(shape)
    for row in range(shape[0]):
        M[row, indices[indptr[row] : indptr[row + 1]]] = data[indptr[row] : indptr[row + 1]]
else:
    M = at["M"][()]
assert M.shape == (n, n)
x, y = points.T
one, zero = np.ones_like(x), np.zeros_like(x)
rigid = [np.column_stack(r).ravel() for r in ([one, zero], [zero, one], [-y, x])]
for a, name in ((V, "V"), (W, "W"), (S, "S")):
    assert np.abs(a - a.T).max() <= 1e-14 * np.abs(a).max(), name
assert np.linalg.eigvalsh(V).min() > 0
spectrum = np.linalg.eigvalsh(S)
assert np.all(np.abs(spectrum[:3]) < 1e-12 * spectrum[-1]) and spectrum[3] > 1e-6 * spectrum[-1], spectrum[:4]
for r in rigid:
    for a, name in ((W, "W"), (S, "S"), (0.5 * M + K, "M/2 + K")):
        scale = np.abs(a) @ np.abs(r)
        assert np.abs(a @ r).max() <= 1e-12 * scale.max(), (name, np.abs(a @ r).max())
# a motion that is not rigid is not in the kernel
stretch = np.column_stack([x, zero]).ravel()
assert stretch @ S @ stretch > 1
half = 0.5 * M + K
made = W + half.T @ np.linalg.solve(V, half)
assert np.abs(made - S).max() <= 1e-11 * np.abs(S).max(), np.abs(made - S).max()
# u = (x, 0): the energy of the uniform strain, E (1-ν) / ((1+ν)(1-2ν)) times the area 1
assert abs(stretch @ S @ stretch - 200 * 0.7 / (1.3 * 0.4)) < 1e-9
# the same matrices lie under their step
assert file["steps/001/matrices/S"] == at["S"] and file["steps/000/matrices/S"].shape == (n // 2, n // 2)
