"""Reads the file of tests/steklov.rs with h5py and demands what the datasets say of one another."""

import sys

import h5py
import numpy as np


def close(a, b):
    assert np.abs(a - b).max() < 1e-11 * np.abs(b).max(), np.abs(a - b).max() / np.abs(b).max()


def sparse(group):
    full = np.zeros(group["shape"][:])
    for row, (first, end) in enumerate(zip(group["indptr"][:-1], group["indptr"][1:])):
        full[row, group["indices"][first:end]] = group["data"][first:end]
    return full


with h5py.File(sys.argv[1]) as file:
    operators, steklov, condensation = file["operators"], file["steklov"], file["condensation"]
    v, k, w, m = operators["V"][:], operators["K"][:], operators["W"][:], sparse(operators["M"])
    h = m / 2 + k
    s, factor, solved = (steklov[name][:] for name in ("S", "factor", "solved"))
    assert steklov["domain"].asstr()[()] == "interior"
    lower = np.tril(factor)
    close(s, w + h.T @ np.linalg.solve(v, h))
    close(lower @ lower.T, v)
    assert np.array_equal(np.triu(factor, 1), np.triu(v, 1))
    close(lower @ solved, h)
    close(s, w + solved.T @ solved)
    assert np.array_equal(s, s.T)

    names = ("eliminated", "kept", "held", "S", "L", "coupling", "condensed")
    eliminated, kept, held, ordered, lower, coupling, condensed = (condensation[name][:] for name in names)
    order = np.concatenate([eliminated, kept, held])
    assert sorted(order) == list(range(len(s)))
    turn = np.eye(len(s))
    for node, directions in zip(condensation["frame_nodes"][:], condensation["frames"][:].reshape(-1, 2, 2)):
        turn[2 * node : 2 * node + 2, 2 * node : 2 * node + 2] = directions
    close(ordered, (turn @ s @ turn.T)[np.ix_(order, order)])
    r, k = len(eliminated), len(kept)
    s_rr, s_rk, s_kk = ordered[:r, :r], ordered[:r, r : r + k], ordered[r : r + k, r : r + k]
    close(lower @ lower.T, s_rr)
    close(coupling @ lower.T, s_rk.T)
    close(condensed, s_kk - s_rk.T @ np.linalg.solve(s_rr, s_rk))

    def labelled(name, thing):
        if isinstance(thing, h5py.Dataset):
            assert {"unit", "meaning"} <= set(thing.attrs), name
            assert len(thing.attrs.get("axes", [])) == thing.ndim, name

    file.visititems(labelled)
    for group, name, formula in [
        (steklov, "S", b"S = W + H^T V^-1 H"),
        (steklov, "factor", b"V = L L^T"),
        (condensation, "coupling", b"C = S_KR L^-T"),
        (condensation, "condensed", b"S_c = S_KK - C C^T"),
    ]:
        assert formula in group[name].attrs["meaning"], name
