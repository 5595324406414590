"""Multiscale bases keep rigid motions, which meet no resistance; bases of patches that overlap do not conform.

usage: rigid_motions_of_basis.py (FILE HANGING)...   HANGING is "hanging" for a mesh with hanging nodes, else empty
"""

import sys

import h5py
import numpy as np


def dense(group):
    indptr, indices, data, shape = (group[name][()] for name in ("indptr", "indices", "data", "shape"))
    matrix = np.zeros(shape)
    matrix[np.repeat(np.arange(shape[0]), np.diff(indptr)), indices] = data
    return matrix


def check(file, hanging):
    last = sorted(file["steps"])[-1]
    at = file["basis"]
    assert file[f"steps/{last}/basis"] == at and file[f"steps/{last}/matrices"] == file["matrices"]
    K, P, C, K_H = (dense(group) for group in (at["K"], at["P"], at["C"], file["matrices/K_H"]))
    kind = at["kind"][()].decode()
    galerkin = np.abs(P.T @ K @ P - K_H).max() / np.abs(K_H).max()
    assert (galerkin > 1e-9) == kind.startswith(("oversampled", "periodic")), (kind, galerkin)

    points, where = (at["place"][()][0] + at["place"][()][1] * at[name][()] for name in ("nodes", "vertices"))
    own = [row for row in range(len(C)) if np.count_nonzero(C[row]) == 1 and C[row].max() == 1]
    assert hanging == (len(own) < len(C))
    for move in (lambda x, y: (1 + 0 * x, 0 * x), lambda x, y: (0 * x, 1 + 0 * x), lambda x, y: (-y, x)):
        fine, coarse = (np.column_stack(move(*p.T)).ravel() for p in (points, where))
        U = np.zeros(C.shape[1])
        U[[int(np.flatnonzero(C[row])[0]) for row in own]] = coarse[own]
        assert np.abs(C @ U - coarse).max() <= 1e-12 * np.abs(coarse).max()
        assert np.abs(P @ U - fine).max() <= 1e-11 * np.abs(fine).max()
        assert np.abs(K_H @ U).max() <= 1e-11 * np.abs(K_H).max() * np.abs(U).max()

    # what acts on the boundary is more than rounding, and its sum is the loads and reactions
    v, f = file["multiscale/vertex_displacement"][()].ravel(), file["matrices/f"][()]
    U = np.zeros(C.shape[1])
    U[[int(np.flatnonzero(C[row])[0]) for row in own]] = v[own]
    size = (np.abs(K_H) @ np.abs(U)).max()
    assert np.abs(K_H @ U - f).max() > 1e-6 * size
    reactions = [force[()] for force in file["solution/reactions"].values()]
    if reactions:
        assert np.abs((K_H @ U - f).reshape(-1, 2).sum(axis=0) - sum(reactions)).max() <= 1e-12 * size


for name, hanging in zip(sys.argv[1::2], sys.argv[2::2], strict=True):
    check(h5py.File(name), hanging == "hanging")
