"""Reads every path of a result of scenes/block-on-floor.toml with h5py and judges it by what must hold."""

import json
import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
told = json.load(open(sys.argv[2]))
text = lambda value: value.decode() if isinstance(value, bytes) else str(value)


def read(path, shape, kind, unit, axes):
    """An array and what its attributes say of it."""
    data = file[path]
    assert data.shape == shape, (path, data.shape, shape)
    assert data.dtype == kind, (path, data.dtype)
    assert text(data.attrs["unit"]) == unit, (path, data.attrs["unit"])
    assert len(text(data.attrs["meaning"])) > 2, path
    assert [text(a) for a in np.atleast_1d(data.attrs["axes"])] == axes, (path, data.attrs["axes"])
    assert data.size == 0 or data.fletcher32, path + " has no checksum"
    return data[()]


F8, I8 = np.float64, np.int64
close = lambda a, b, tol: np.testing.assert_allclose(a, b, rtol=0, atol=tol)

# The root
assert text(file.attrs["format"]) == "steklov" and file.attrs["format_version"] == 1
assert text(file.attrs["program"]).startswith("steklov ") and file.attrs["threads"] >= 1
scene = text(file["scene"][()])
assert "Thesis 2.7" in scene and "[sides.floor]" in scene
assert [text(t) for t in file["overrides"]][:2] == ['method.refine="uniform-h"', "method.max_steps=2"]
plan = json.loads(text(file["plan"][()]))
assert plan["model"] == "bem" and any(d["what"] == "contact" for d in plan["modelled"]) and plan["left_out"]
summary = json.loads(text(file["summary"][()]))
differing = {key for key in told if told[key] != summary[key]}
assert differing <= {"seconds"}, differing

# The mesh: 64 elements of degree 4 on the square, closed, with the right length
e, p = 64, 4
nodes = read("mesh/nodes", (e, 2), F8, "length", ["node", "xy"])
elements = read("mesh/elements", (e, 2), I8, "1", ["element", "start, end"])
degree = read("mesh/degree", (e,), I8, "1", ["element"])
side = read("mesh/side", (e,), I8, "1", ["element"])
names = [text(t) for t in file["mesh/side_names"]]
assert names == ["floor", "right", "top", "left"] and np.all(degree == p) and np.all(np.bincount(side) == 16)
along = nodes[elements[:, 1]] - nodes[elements[:, 0]]
length = np.hypot(*along.T)
close(length, 1 / 16, 1e-15)
close(np.abs(nodes).max(axis=1), 0.5, 0)
normal = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
assert np.all(np.einsum("ij,ij->i", nodes, normal) > 0), "the normal points out"

# Displacement and traction
k = e * p
points = read("solution/points", (k, 2), F8, "length", ["node", "component"])
displacement = read("solution/displacement", (k, 2), F8, "length", ["node", "component"])
corner = np.flatnonzero((points == [-0.5, -0.5]).all(axis=1))
assert len(corner) == 1
# verification.md: displacement at (-1/2, -1/2)
close(displacement[corner[0]], [0.05067434, 0.01137091], 5e-5)
at = read("solution/traction_points", (k, 2), F8, "length", ["point", "component"])
element = read("solution/traction_element", (k,), I8, "1", ["point"])
traction = read("solution/traction", (k, 2), F8, "stress", ["point", "component"])
prescribed = read("solution/traction_prescribed", (k, 2), F8, "stress", ["point", "component"])
given = {name: prescribed[side[element] == i] for i, name in enumerate(names)}
assert np.isnan(given["floor"]).all() and not np.isnan(np.concatenate([given[n] for n in ("left", "top", "right")])).any()
x = at[side[element] == names.index("top"), 0]
close(given["top"], np.stack([0 * x, -500 * (0.5 - x) ** 2 * (0.5 + x) ** 2], axis=1), 1e-13)
gauss, weights = np.polynomial.legendre.leggauss(p)
middle = (nodes[elements[:, 0]] + nodes[elements[:, 1]]) / 2
close(at, (middle[:, None, :] + gauss[None, :, None] * along[:, None, :] / 2).reshape(-1, 2), 1e-15)
assert np.array_equal(element, np.repeat(np.arange(e), p))
parts = traction * (np.tile(weights, e) * length[element] / 2)[:, None]
force = {name: parts[side[element] == i].sum(axis=0) for i, name in enumerate(names)}
# Boundary tractions are in balance, and those of the sides are the data and the reaction, up to discretisation.
close(sum(force.values()), [0, 0], 1e-4)
close(force["floor"], [0, 40 / 3], 2e-2)
close(force["top"], [0, -500 / 30], 2e-2)
close(force["left"] + force["right"], [0, 10 / 3], 2e-2)
reactions = read("solution/reactions/floor", (2,), F8, "force/thickness", ["component"])
assert list(file["solution/reactions"]) == ["floor"]
close(reactions, [0, 40 / 3], 1e-11)
close(reactions, told["reactions"]["floor"], 0)
close(read("solution/probe/points", (2, 2), F8, "length", ["point", "component"]), [[0, 0], [0.5, 0.1]], 0)
for i, probe in enumerate(told["probe"]):
    close(read("solution/probe/displacement", (2, 2), F8, "length", ["point", "component"])[i], probe["displacement"], 0)
    close(read("solution/probe/stress", (2, 3), F8, "stress", ["point", "component"])[i], probe["stress"], 0)

# Contact: one row for each node of the floor
node = ["contact node"]
c = 16 * p + 1
where = read("contact/points", (c, 2), F8, "length", ["contact node", "component"])
close(where[:, 1], -0.5, 0)
out = read("contact/normal", (c, 2), F8, "1", ["contact node", "component"])
close(out, np.tile([0.0, -1.0], (c, 1)), 1e-15)
column = lambda name, unit: read("contact/" + name, (c,), F8, unit, node)
gap, u_n, u_t = (column(name, "length") for name in ("gap", "normal_displacement", "tangential_displacement"))
pressure, shear, bound = (column(name, "stress") for name in ("pressure", "shear", "bound"))
weight = column("weight", "length")
status = read("contact/status", (c,), I8, "1", node)
assert np.all(read("contact/side", (c,), I8, "1", node) == 0)
close(weight.sum(), 1, 1e-14)
close((pressure * weight).sum(), 40 / 3, 1e-11)
close((shear * weight).sum(), 0, 1e-11)
close(bound, 0.3, 1e-15)
close(gap, 0, 0)
size = np.abs(displacement).max()
assert np.all(u_n <= 1e-11 * size) and np.all(pressure >= -1e-11 * pressure.max()) and np.all(np.abs(shear) <= 0.3 * (1 + 1e-11))
close(pressure * u_n, 0, 1e-10)
assert set(status) <= {0, 1, 2, 3}
assert np.array_equal(status == 0, pressure <= 1e-12 * pressure.max())
# slip: the shear pulls against the motion
slipping = np.isin(status, [2, 3])
assert np.all(np.sign(u_t[slipping]) == np.where(status[slipping] == 2, 1, -1))
close((weight * 0.3 * np.abs(u_t)).sum(), told["friction_work"], 1e-13)
close(weight[status > 0].sum(), told["contact"]["length"], 1e-12)
# that of the enriched spaces between the nodes
close(pressure.max(), told["contact"]["max_pressure"], 2e-3 * pressure.max())
for row, x in enumerate(where):
    i = np.flatnonzero((points == x).all(axis=1))[0]
    close([-displacement[i, 1], displacement[i, 0]], [u_n[row], u_t[row]], 1e-15)

# Steps
assert list(file["steps"]) == ["000", "001"]
for number, elements in [("000", 32), ("001", 64)]:
    at = f"steps/{number}/"
    assert read(at + "mesh/nodes", (elements, 2), F8, "length", ["node", "xy"]).shape[0] == elements
    assert np.all(read(at + "mesh/degree", (elements,), I8, "1", ["element"]) == p)
    assert read(at + "dofs", (1,), I8, "1", ["value"])[0] == 2 * p * elements
    history = file[at + "history"][()]
    assert len(history) >= 2 and history[-1] < 1e-9 * max(1, history[0])
    seconds = read(at + "seconds", (5,), F8, "seconds", ["part"])
    assert np.all(seconds > 0)
    # the estimate is a mean of the two-level sum, which has the error of the traction in it, and of the correction
    joule = "force*length/thickness"
    number = lambda name, unit: read(at + name, (1,), F8, unit, ["value"])[0]
    estimate = number("estimate", f"({joule})^(1/2)")
    relative, scale, correction, tips, _, uncertainty = file[at + "estimate_terms"][()]
    names = ("displacement", "traction", "oscillation")
    terms = [read(at + "indicators/" + name, (elements,), F8, joule, ["element"]) for name in names]
    assert np.all(np.array(terms) >= 0)
    assert 0.9 * correction <= estimate**2 <= 1.1 * np.sum(terms)
    close(relative * scale, estimate, 1e-15)
    assert tips == 0 and uncertainty > 0
energy = [float(np.squeeze(file[f"steps/{n}/energy"][()])) for n in ("000", "001")]
assert energy[1] == told["energy"]
assert estimate == told["estimate"]
# verification.md: J; the finer step is the better one
errors = [abs(j + 2.9933291930708) for j in energy]
assert errors[1] < errors[0] and errors[1] < 1e-5, errors

# Every dataset has its labels and a checksum.
def check(name, item):
    if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu" and item.size:
        assert item.fletcher32, name + " has no checksum"
    if isinstance(item, h5py.Dataset):
        assert "meaning" in item.attrs, name + " has no meaning"


file.visititems(check)
