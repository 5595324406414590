"""Compares the body that a page of `steklov report` embeds with the points and fields of the result file.

usage: embedded_body.py RESULT.vtkhdf PAGE.html
"""

import base64
import json
import re
import sys

import h5py
import numpy as np

page = open(sys.argv[2], encoding="utf-8").read()
data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S).group(1))


def numbers(name):
    return data[name]["scale"] * np.frombuffer(base64.b64decode(data[name]["base64"]), "<f4").astype(float)


points = np.array(data["origin"]) + np.stack([numbers("x"), numbers("y")], axis=1)
size = np.ptp(points, axis=0).max()
triangles = np.frombuffer(base64.b64decode(data["triangles"]), "<u2").reshape(-1, 3)
assert triangles.max() < len(points) and len(triangles) > 0

with h5py.File(sys.argv[1]) as file:
    grid = file["VTKHDF"]
    stored = grid["Points"][:, :2]
    displacement = grid["PointData/displacement"][:]
    types = grid["Types"][:]
    offsets, corners = grid["Offsets"][:], grid["Connectivity"][:]
    nearest = np.arange(len(stored))
    if "stress" in grid["PointData"]:
        # they are all of them, in their order, so that bodies that touch keep their own values
        assert len(points) == len(stored)
        stress, mises = grid["PointData/stress"][:], grid["PointData/von_mises"][:]
        assert np.array_equal(triangles, np.stack([corners[offsets[:-1][types == 5] + k] for k in range(3)], axis=1))
    else:
        # the mean over the cells around each node
        sums, counts = np.zeros((len(stored), 4)), np.zeros(len(stored))
        values = np.column_stack([grid["CellData/stress"][:], grid["CellData/von_mises"][:]])
        for cell in np.nonzero(types != 3)[0]:
            around = corners[offsets[cell] : offsets[cell + 1]]
            sums[around] += values[cell]
            counts[around] += 1
        assert counts.min() > 0
        means = sums / counts[:, None]
        # the page has nodes of the body first, then all points of the medium in their order
        body = np.unique(np.concatenate([corners[offsets[cell] : offsets[cell] + 4] for cell in np.nonzero(types == 9)[0]]))
        medium = np.setdiff1d(np.arange(len(stored)), body)
        own = len(points) - len(medium)
        of_body = [body[np.argmin(((stored[body] - x) ** 2).sum(axis=1))] for x in points[:own]]
        nearest = np.concatenate([of_body, medium]).astype(int)
        stress, mises = means[:, :3], means[:, 3]

    def same(shown, exact):
        finite = np.isfinite(exact)
        assert np.array_equal(np.isfinite(shown), finite)
        largest = np.abs(exact[finite]).max()
        assert np.abs(shown[finite] - exact[finite]).max() <= 1e-6 * largest, (shown, exact)

    assert np.abs(stored[nearest] - points).max() <= 1e-6 * size
    for k, name in enumerate(["ux", "uy"]):
        same(numbers(name), displacement[nearest, k])
    for k, name in enumerate(["xx", "yy", "xy"]):
        same(numbers(name), stress[nearest, k])
    same(numbers("mises"), mises[nearest])

# the triangles are turned counter-clockwise and fill as much as they say
a, b, c = (points[triangles[:, k]] for k in range(3))
areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
assert areas.min() > -1e-6 * size**2 and areas.sum() > 0
print("the body of the page is that of the file")
