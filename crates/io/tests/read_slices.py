"""Rows of a dense matrix slice by slice: the numbers, and memory of the slice and of a chunk, not of the matrix."""

import sys
import tracemalloc

import h5py
import numpy as np

with h5py.File(sys.argv[1]) as file:
    a = file["a"]
    assert a.chunks[1] == a.shape[1] and a.chunks[0] * 4 < a.shape[0], a.chunks
    assert a.nbytes > 8_000_000
    tracemalloc.start()
    for first in range(0, a.shape[0], 50):
        rows = a[first : first + 50]
        number = 1000 * np.arange(first, first + len(rows))[:, None] + np.arange(1000)
        assert (rows == number).all(), first
    peak = tracemalloc.get_traced_memory()[1]
    assert 50 * 8000 < peak < a.nbytes / 4, peak
