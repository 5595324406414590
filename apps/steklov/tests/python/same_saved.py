"""What --save has stored in two files: the same paths, labels and bits."""

import sys

import h5py
import numpy as np

NAMES = ["matrices", "contact_problem", "stabilisation", "basis"]
OF_RUN = ["stochastic/outcomes", "stochastic/cells", "stochastic/eigenpairs"]
one, other = (h5py.File(name) for name in sys.argv[1:3])
expected = set(sys.argv[3:])


def content(group):
    found = {}

    def add(name, item):
        labels = {key: str(value) for key, value in item.attrs.items()}
        found[name] = (labels, item.dtype, item[()].tobytes()) if isinstance(item, h5py.Dataset) else (labels,)

    group.visititems(add)
    return found


assert sorted(one["steps"]) == sorted(other["steps"]) and len(one["steps"]) > 2
seen = set()
for name in OF_RUN:
    assert (name in one) == (name in other) == (name in expected), name
    if name in one:
        assert content(one[name]) == content(other[name]) and len(one[name]) > 0, name
        seen.add(name)
for step in one["steps"]:
    for name in NAMES:
        at = f"steps/{step}/{name}"
        assert (at in one) == (at in other) == (name in expected), at
        if at in one:
            a, b = content(one[at]), content(other[at])
            assert a.keys() == b.keys() and len(a) > 2, at
            for path in a:
                assert a[path] == b[path], f"{at}/{path}"
            seen.add(name)
last = sorted(one["steps"])[-1]
for name in expected - set(OF_RUN):
    assert one[name] == one[f"steps/{last}/{name}"] and other[name] == other[f"steps/{last}/{name}"], name
assert seen == expected
