"""Reads /stochastic of a result with h5py and judges it by what must hold."""

import json
import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
told = json.load(open(sys.argv[2]))["stochastic"]
at = file["stochastic"]
text = lambda value: value.decode() if isinstance(value, bytes) else str(value)
texts = lambda data: [text(t) for t in data]


def read(path, shape, unit, axes):
    """An array and what its attributes say of it."""
    data = at[path]
    assert data.shape == shape, (path, data.shape, shape)
    assert data.dtype == np.float64, (path, data.dtype)
    assert text(data.attrs["unit"]) == unit, (path, data.attrs["unit"])
    assert len(text(data.attrs["meaning"])) > 2, path
    assert texts(np.atleast_1d(data.attrs["axes"])) == axes, (path, data.attrs["axes"])
    assert data.fletcher32, path + " has no checksum"
    return data[()]


close = lambda a, b, tol: np.testing.assert_allclose(a, b, rtol=0, atol=tol)

germs = texts(at["germs"])
assert germs == ["rough 1", "rough 2", "p"] == told["solution"]["germs"]
count = told["solution"]["points"]
points = read("points", (count, 3), "1", ["point", "germ"])
weights = read("weights", (count,), "1", ["point"])
close(weights.sum(), 1, 1e-14)
# the germs of the modes have mean 0 and variance 1, the load is uniform on (0.8, 1.2)
close(weights @ points, [0, 0, 1], 1e-14)
close(weights @ (points - [0, 0, 1]) ** 2, [1, 1, 0.16 / 12], 1e-13)
close(read("young", (count,), "stress", ["point"]), 200, 0)

nodes = len(file["solution/points"])
u = read("displacements", (count, 2 * nodes), "length", ["point", "unknown"])
mean = read("displacement/mean", (2 * nodes,), "length", ["entry"])
size = np.abs(u).max()
close(weights @ u, mean, 1e-13 * size)
close(weights @ (u - mean) ** 2, read("displacement/variance", (2 * nodes,), "length^2", ["entry"]), 1e-13 * size**2)
# with one modulus for all the mean stress is that of the mean displacement
close(read("stress_displacement", (2 * nodes,), "length", ["unknown"]), mean, 1e-13 * size)

rows = len(file["contact/points"])
weight = file["contact/weight"][()]
pressure = read("pressure/mean", (rows,), "stress", ["entry"])
# the block is pressed down with 2 p, all of which the floor carries
close(weight @ pressure, 2, 1e-11)
for name in ("pressure", "shear"):
    assert np.all(read(name + "/variance", (rows,), "stress^2", ["entry"]) >= 0)
probability = read("probability", (rows,), "1", ["contact node"])
assert np.all((0 <= probability) & (probability <= 1)) and probability.max() == 1

probabilities = read("probabilities", (3,), "1", ["probability"])
close(probabilities, [0.05, 0.5, 0.95], 0)
names = texts(at["quantity_names"])
assert names[0] == "energy" and "contact.force.y" in names
of = "of the quantity"
for k, name in enumerate(names):
    q = f"quantities/{k}/"
    values = read(q + "values", (count,), of, ["point"])
    both = read(q + "moments", (2,), of, ["moment"])
    scale = np.abs(values).max()
    close([weights @ values, weights @ (values - both[0]) ** 2], both, 1e-12 * max(scale, scale**2))
    one = told
    for key in name.split("."):
        one = one[key]
    assert one["mean"] == both[0] and one["variance"] == both[1]
    # 0 but for rounding, whatever the outcome
    rounding = scale < 1e-10
    assert rounding == (name == "contact.force.x"), name
    for part in ("quantiles", "effects"):
        assert (one[part] is None) == (part not in at[q]) == rounding, (name, part)
    if rounding:
        assert "density" not in at[q]
        continue
    assert list(read(q + "quantiles", (3,), of, ["probability"])) == one["quantiles"]
    effects = read(q + "effects", (3,), "1", ["germ"])
    assert list(effects) == [one["effects"][g] for g in germs]
    if "density" in at[q]:
        bins = at[q + "bins"][()]
        density = read(q + "density", (len(bins) - 1,), "1/quantity", ["bin"])
        close(density @ np.diff(bins), 1, 1e-12)
force = names.index("contact.force.y")
# F = 2 p: mean 2, variance 4 * 0.4^2 / 12; only the load matters to it
close(at[f"quantities/{force}/moments"][()], [2, 0.64 / 12], 1e-11)
close(at[f"quantities/{force}/effects"][:2], 0, 1e-12)

assert texts(at["field_names"]) == ["rough"]
eigenvalues = read("fields/0/eigenvalues", (2,), "length^d", ["mode"])
assert eigenvalues[0] > eigenvalues[1] > 0
where = read("fields/0/points", at["fields/0/points"].shape, "length", ["point", "component"])[:, 0]
close([where[0], where[-1]], [0, 2], 1e-15)
modes = read("fields/0/modes", (len(where), 2), "1", ["point", "mode"])
# modes are orthogonal, with squares of the size of the eigenvalues; the trapezoidal rule
step = np.diff(where)
product = lambda a, b: np.sum(step * (a[1:] * b[1:] + a[:-1] * b[:-1]) / 2)
for i in range(2):
    for j in range(2):
        close(product(modes[:, i], modes[:, j]), eigenvalues[i] if i == j else 0, 1e-4)

cells = told["solution"]["cells"]
low, high = (read("mesh/" + end, (cells, 3), "1", ["cell", "germ"]) for end in ("low", "high"))
assert np.all(low < high)
assert np.all(read("mesh/degree", (cells, 3), "1", ["cell", "germ"]) == 2)
assert np.all(read("mesh/truncation_by_germ", (3,), "1", ["germ"]) >= 0)
