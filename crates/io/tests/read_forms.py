"""Reads the file of tests/multipliers.rs with h5py and demands what the datasets say of one another."""

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
    forms, space = file["forms"], file["space"]
    weights, damping = forms["weights"][:], forms["damping"][0]
    traces, values = ([forms[f"{name}_{k}"][:] for k in "nt"] for name in ("trace", "values"))
    close(forms["B_gamma"][:], sum(trace.T @ trace for trace in traces))
    for k, trace, value in zip("nt", traces, values):
        close(forms[f"C_gamma_{k}"][:], value.T @ trace)
        close(forms[f"D_gamma_{k}"][:], value.T @ value)
    pressure = weights / np.linalg.norm(weights)
    close(values[1].sum(axis=1), weights)
    close(values[0], values[1] - damping * np.outer(pressure, pressure @ values[1]))

    # int mu_i n phi_j over all j with phi_j = n is int mu_i: the floor has n = (0, -1)
    normal, weight = space["normal"][:], space["weight"][:]
    assert np.allclose(normal, [0, -1]) and np.allclose(space["tangent"][:], [1, 0])
    close(-sparse(forms["pairing_n"])[:, 1::2].sum(axis=1), weight)
    close(sparse(forms["pairing_t"])[:, 0::2].sum(axis=1), weight)
    assert np.isclose(weight.sum(), 1)

    def labelled(name, thing):
        if isinstance(thing, h5py.Dataset):
            assert {"unit", "meaning"} <= set(thing.attrs), name
            assert len(thing.attrs.get("axes", [])) == thing.ndim, name

    file.visititems(labelled)
    assert b"B_gamma = gamma_0 B" in forms["B_gamma"].attrs["meaning"]
    assert b"C_gamma = gamma_0 C" in forms["C_gamma_n"].attrs["meaning"]
    assert b"D_gamma = gamma_0 D" in forms["D_gamma_t"].attrs["meaning"]
