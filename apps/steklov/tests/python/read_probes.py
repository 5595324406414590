"""Reads results along lines and sides with h5py, beside the JSON object of the command and the tables of --plots: FILE TOLD LINE SIDE."""

import csv
import json
import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
told = json.load(open(sys.argv[2]))
tables = [list(csv.DictReader(open(name))) for name in sys.argv[3:5]]
text = lambda value: value.decode() if isinstance(value, bytes) else str(value)
numbers = lambda values: np.array(values, dtype=float)  # null is NaN
same = np.testing.assert_array_equal
column = lambda table, *names: np.squeeze([[float(row[name] or "nan") for name in names] for row in table])


def check(group, points, units):
    assert set(group) == set(units), set(group) ^ set(units)
    for name, unit in units.items():
        assert text(group[name].attrs["unit"]) == unit and group[name].fletcher32, name
        if unit != "text":
            same(group[name][()], numbers([point[{"points": "point"}.get(name, name)] for point in points]))


lines = file["solution/probe/lines"]
assert list(lines) == ["1", "2"] and "points" not in file["solution/probe"]
of_line = {"s": "length", "points": "length", "displacement": "length", "stress": "stress", "von_mises": "stress"}
for name, line in zip(lines, told["probe_lines"]):
    check(lines[name], line["points"], of_line)
    same(lines[name]["points"][0], line["from"])
    same(lines[name]["points"][-1], line["to"])
first = lines["1"]
outside = np.isnan(first["von_mises"][:])
same(outside, np.isnan(first["displacement"][:, 0]))
same(outside, np.isnan(first["stress"][:, 2]))
assert outside.sum() == 16 and len(outside) == 27
same(column(tables[0], "s"), first["s"][:])
same(column(tables[0], "ux", "uy"), first["displacement"][:])
same(column(tables[0], "sigma_xx", "sigma_yy", "sigma_xy"), first["stress"][:])
assert tables[0][0]["ux"] == "" and "body" not in tables[0][0]

sides = file["solution/probe/sides"]
assert list(sides) == ["hole_1"]
side = sides["hole_1"]
assert told["probe_sides"][0]["side"] == tables[1][0]["side"] == "hole/1"
of_side = dict(of_line, normal="1", piece="1")
of_side |= dict.fromkeys(("normal_displacement", "tangential_displacement"), "length")
of_side |= dict.fromkeys(("normal_traction", "tangential_traction", "hoop_stress"), "stress")
check(side, told["probe_sides"][0]["points"], of_side)
same(column(tables[1], "traction_n", "traction_t", "hoop"), np.array([side[k][:] for k in ("normal_traction", "tangential_traction", "hoop_stress")]).T)
# the traction is that of the stress, and u_n, u_t are components of u
n, u, s = side["normal"][:], side["displacement"][:], side["stress"][:]
t = np.stack([-n[:, 1], n[:, 0]], axis=1)
traction = np.stack([s[:, 0] * n[:, 0] + s[:, 2] * n[:, 1], s[:, 2] * n[:, 0] + s[:, 1] * n[:, 1]], axis=1)
close = lambda a, b: np.testing.assert_allclose(a, b, rtol=0, atol=1e-12)
close((traction * n).sum(1), side["normal_traction"][:])
close((traction * t).sum(1), side["tangential_traction"][:])
close((u * n).sum(1), side["normal_displacement"][:])
close((u * t).sum(1), side["tangential_displacement"][:])
close(s[:, 0] + s[:, 1] - side["normal_traction"][:], side["hoop_stress"][:])
np.testing.assert_allclose(side["normal_traction"][:], -1, atol=1e-3)
np.testing.assert_allclose(side["hoop_stress"][:], 5 / 3, atol=1e-3)
