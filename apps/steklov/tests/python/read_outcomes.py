"""The outcomes of --save stochastic: statistics, masses of stochastic cells and modes of fields, from the file alone."""

import itertools
import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
wanted = set(sys.argv[2:])
at = file["stochastic"]
text = lambda value: value.decode() if isinstance(value, bytes) else str(value)
worst = {}


def labelled(name, item):
    if isinstance(item, h5py.Dataset):
        for key in ("unit", "meaning"):
            if item.shape != ():
                assert len(text(item.attrs[key])) > 0, (name, key)
        assert item.shape == () or len(item.attrs["axes"]) == item.ndim, name
        assert item.shape == () or item.size == 0 or item.fletcher32, name


for name in ("outcomes", "cells", "eigenpairs"):
    assert (name in at) == (name in wanted), name
    if name in at:
        at[name].visititems(labelled)


def close(what, a, b, scale=None):
    scale = np.abs(b).max() if scale is None else scale
    worst[what] = max(worst.get(what, 0), np.abs(a - b).max() / scale)
    assert worst[what] <= 1e-12, (what, worst[what])


# Every outcome: means and variances are those of the points with their weights
points, weights = at["points"][()], at["weights"][()]
for name in ("displacement", "pressure", "shear"):
    values, mean, variance = at[f"outcomes/{name}"][()], at[f"{name}/mean"][()], at[f"{name}/variance"][()]
    assert values.shape == (len(points), len(mean)) and np.isfinite(values).all()
    if values.size == 0:
        continue
    size = np.abs(values).max() or 1
    close("mean", weights @ values, mean, size)
    close("variance", weights @ (values - mean) ** 2, variance, size**2)
assert np.ptp(at["outcomes/displacement"][()], axis=0).max() > 0
if "displacements" in at:
    assert np.array_equal(at["displacements"][()], at["outcomes/displacement"][()])
# contact keeps its signs, and its share of the outcomes is the probability of contact
pressure = at["outcomes/pressure"][()]
if pressure.size:
    assert pressure.min() >= -1e-9 * pressure.max()

# Cells: masses are sums over the products of the axes' points
first = 0
if "cells" in at:
    cells = sorted(at["cells"])
    low, high = at["mesh/low"][()], at["mesh/high"][()]
    assert cells == [f"{k:05}" for k in range(len(low))]
    for k, cell in enumerate(cells):
        cell = at["cells"][cell]
        nodes, D = cell["basis/points"][()], cell["basis/weights"][()]
        own = slice(first, first + len(D))
        assert np.array_equal(points[own], nodes) and np.array_equal(weights[own], D)
        first += len(D)
        axes = [cell[f"axis_{d}"] for d in range(nodes.shape[1])]
        theta, w = np.ones((1, 1)), np.ones(1)
        for d, axis in enumerate(axes):
            x, v, values = axis["points"][()], axis["weights"][()], axis["values"][()]
            assert low[k, d] <= x.min() and x.max() <= high[k, d]
            # Lagrange polynomials of the nodes of the axis
            own_nodes = np.unique(nodes[:, d])
            for i, j in itertools.product(range(len(x)), range(len(own_nodes))):
                others = np.delete(own_nodes, j)
                exact = np.prod((x[i] - others) / (own_nodes[j] - others))
                close("theta", values[i, j], exact, max(1, abs(exact)))
            theta, w = np.kron(theta, values), np.kron(w, v)
        close("mass", (theta * w[:, None]).T @ theta, cell["mass"][()])
        close("D", np.diag(D), cell["mass"][()])
        if "modulus" in wanted:
            E = cell["modulus"][()]
            assert E.shape == w.shape and np.ptp(E) > 0 and E.min() > 0
            M_E = cell["M_E"][()]
            close("M_E", (theta * (w * E)[:, None]).T @ theta, M_E)
            close("M_E is symmetric", M_E, M_E.T)
            assert np.linalg.eigvalsh(M_E).min() > 0
        else:
            assert "M_E" not in cell and "modulus" not in cell
    assert first == len(points)

# Fields: modes are orthogonal with their eigenvalues as squares
if "eigenpairs" in at:
    for k in at["eigenpairs"]:
        pair, stored = at["eigenpairs"][k], at["fields"][k]
        w, modes, eigenvalues = pair["weights"][()], pair["modes"][()], pair["eigenvalues"][()]
        assert len(pair["points"]) == len(w) == len(modes) and np.array_equal(eigenvalues, stored["eigenvalues"][()])
        close("modes", (modes * w[:, None]).T @ modes, np.diag(eigenvalues))
        close("captured", eigenvalues.sum() / w.sum(), stored["captured"][0], 1)
print(len(points), "outcomes", " ".join(f"{name} {value:.1e}" for name, value in worst.items()))
