"""The multiscale basis of --save matrices,basis: bases, prolongation and coarse stiffness, from the file alone."""

import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
text = lambda value: value.decode() if isinstance(value, bytes) else str(value)
last = sorted(file["steps"])[-1]
at, matrices = file["basis"], file["matrices"]
assert file[f"steps/{last}/basis"] == at and file[f"steps/{last}/matrices"] == matrices


def labelled(name, item):
    if isinstance(item, h5py.Dataset):
        for key in ("unit", "meaning"):
            assert len(text(item.attrs[key])) > 0, (name, key)
        assert item.shape == () or len(item.attrs["axes"]) == item.ndim, name
        assert item.shape == () or item.size == 0 or item.fletcher32, name


at.visititems(labelled)


class Sparse:
    """A CSR matrix: its rows are summed by numpy alone."""

    def __init__(self, group):
        self.shape = tuple(group["shape"][()])
        indptr, self.columns, self.data = (group[name][()] for name in ("indptr", "indices", "data"))
        self.rows = np.repeat(np.arange(self.shape[0]), np.diff(indptr))
        assert len(indptr) == self.shape[0] + 1 and indptr[-1] == len(self.data)

    def dense(self):
        matrix = np.zeros(self.shape)
        matrix[self.rows, self.columns] = self.data
        return matrix


def close(a, b, what, scale=None):
    worst = np.abs(a - b).max() / (np.abs(b).max() if scale is None else scale)
    assert worst <= 1e-12, (what, worst)
    return worst


K, P, C, K_H = (Sparse(group).dense() for group in (at["K"], at["P"], at["C"], matrices["K_H"]))
kind = text(at["kind"][()])
conforming = not kind.startswith(("oversampled", "periodic"))

# Fine cells: K = Σ E K_0
nodes, fine, young, unit = (at[name][()] for name in ("nodes", "fine_cells", "young", "K_0"))
number = {tuple(point): k for k, point in enumerate(nodes)}
assert len(number) == len(nodes) and K.shape == (2 * len(nodes),) * 2
corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
assembled = np.zeros_like(K)
for place, modulus in zip(fine, young):
    own = [2 * number[tuple(place + c)] + k for c in corner for k in range(2)]
    assembled[np.ix_(own, own)] += modulus * unit
worst = {"K": close(assembled, K, "K")}
modulus_at = {tuple(place): modulus for place, modulus in zip(fine, young)}

# Coarse cells: R of the pattern at the nodes of the cell, K_T = Rᵀ K R
R, offset, size_of, K_T = (at[name][()] for name in ("R", "offset", "pattern_size", "K_T"))
first, size, pattern, factor = (at[name][()] for name in ("first", "size", "pattern", "factor"))
corners, vertices = at["corners"][()].reshape(-1, 4), at["vertices"][()]
assert R.shape == (offset[-1], 8) and np.array_equal(np.diff(offset), 2 * np.prod(size_of + 1, axis=1))
assert np.array_equal(size, size_of[pattern]) and K_T.shape == (8 * len(size_of), 8)
count, mean, coarse = np.zeros(len(nodes)), np.zeros_like(P), np.zeros_like(K_H)
apart, stiffness_apart = 0.0, 0.0
fields = {}
for T in range(len(first)):
    m, n = size[T]
    local = np.array([[i, j] for j in range(n + 1) for i in range(m + 1)])
    own = np.array([number[tuple(first[T] + p)] for p in local])
    unknowns = np.column_stack([2 * own, 2 * own + 1]).ravel()
    basis = R[offset[pattern[T]] : offset[pattern[T] + 1]]
    rows = (2 * corners[T][:, None] + np.arange(2)).ravel()
    assert np.array_equal(vertices[corners[T]], first[T] + corner * [m, n])
    inner = np.zeros((2 * len(local),) * 2)
    for i in range(m):
        for j in range(n):
            places = [2 * ((j + c[1]) * (m + 1) + i + c[0]) + k for c in corner for k in range(2)]
            inner[np.ix_(places, places)] += modulus_at[tuple(first[T] + [i, j])] * unit
    stiffness = factor[T] * K_T[8 * pattern[T] : 8 * pattern[T] + 8]
    stiffness_apart = max(stiffness_apart, close(stiffness, basis.T @ inner @ basis, f"K_T of {T}"))
    coarse += C[rows].T @ stiffness @ C[rows]
    field = basis @ C[rows]
    for k, row in zip(unknowns, field):
        apart = max(apart, np.abs(fields.setdefault(k, row) - row).max())
    mean[unknowns] += field
    count[own] += 1
worst["K_T"] = stiffness_apart
worst["cells"] = close(coarse, K_H, "K_H from its cells")
worst["P"] = close(mean / np.repeat(count, 2)[:, None], P, "P")
galerkin = np.abs(P.T @ K @ P - K_H).max() / np.abs(K_H).max()
if conforming:
    assert apart <= 1e-12 and galerkin <= 1e-12, (apart, galerkin)
else:
    assert apart > 1e-9 and galerkin > 1e-9, "other functions of other patches"
worst["PKP"] = galerkin

# rigid motions are kept by the basis, and meet no resistance
points = at["place"][()][0] + at["place"][()][1] * nodes
where = at["place"][()][0] + at["place"][()][1] * vertices
own = [2 * k + c for k in range(len(vertices)) for c in range(2)]
unknown = [int(np.flatnonzero(C[row])[0]) if np.count_nonzero(C[row]) == 1 and C[row].max() == 1 else -1 for row in own]
for move in (lambda x, y: (1 + 0 * x, 0 * x), lambda x, y: (0 * x, 1 + 0 * x), lambda x, y: (-y, x)):
    fine_motion, coarse_motion = (np.column_stack(move(*p.T)).ravel() for p in (points, where))
    U = np.zeros(C.shape[1])
    for row, u in zip(own, unknown):
        if u >= 0:
            U[u] = coarse_motion[row]
    assert np.abs(C @ U - coarse_motion).max() <= 1e-12 * np.abs(coarse_motion).max()
    assert np.abs(P @ U - fine_motion).max() <= 1e-11 * np.abs(fine_motion).max()
    assert np.abs(K_H @ U).max() <= 1e-11 * np.abs(K_H).max() * np.abs(U).max()

assert ("hanging" in sys.argv) == (-1 in unknown)

# K_H U = f where no support, contact or medium acts, U the displacement of the vertices; P U is the stored field
v = file["multiscale/vertex_displacement"][()].ravel()
U = np.zeros(C.shape[1])
for row, u in zip(own, unknown):
    if u >= 0:
        U[u] = v[row]
f = matrices["f"][()]
forces = np.abs(K_H @ U - f) / (np.abs(K_H) @ np.abs(U)).max()
x, y = where.T
edge = (x == x.min()) | (x == x.max()) | (y == y.min()) | (y == y.max())
inside = [u for row, u in zip(own, unknown) if u >= 0 and not edge[row // 2]]
worst["f"] = forces[inside].max()
assert worst["f"] <= 1e-12 and forces.max() > 1e-6, worst["f"]
reactions = [force[()] for force in file["solution/reactions"].values()]
if reactions:
    total = (K_H @ U - f).reshape(-1, 2).sum(axis=0)
    worst["reactions"] = np.abs(total - sum(reactions)).max() / (np.abs(K_H) @ np.abs(U)).max()
    assert worst["reactions"] <= 1e-12, worst["reactions"]
displacement = file["VTKHDF/PointData/displacement"][: len(nodes), :2]
assert np.abs(file["VTKHDF/Points"][: len(nodes), :2] - points).max() <= 1e-14 * np.abs(points).max()
worst["field"] = np.abs((P @ U).reshape(-1, 2) - displacement).max() / np.abs(displacement).max()
assert worst["field"] <= 1e-12, worst["field"]
print(kind, " ".join(f"{name} {value:.1e}" for name, value in worst.items()))
