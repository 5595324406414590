"""The table of docs/result-file.md against result files: TABLE FILES...

Every array has a row with its unit and as many axes, and every row is that of an array.
"""

import functools
import re
import sys

import h5py

PLACEHOLDER = re.compile(r"NNNNN|NNN|NAME|SIDE|PART|(?<=_)[KD](?=/|$)|(?<=/)K(?=/[a-z])")
LINKS = ("matrices", "contact_problem", "stabilisation", "basis")
PARTS = {"data": 1, "indices": 1, "indptr": 1, "shape": 1}
text = lambda value: value.decode() if isinstance(value, bytes) else str(value)


def pattern(path, part=""):
    """The paths that a path with placeholders stands for, each with a part behind it."""
    return re.compile("[^/]+".join(re.escape(piece) for piece in PLACEHOLDER.split(path)) + part)


def rows(lines):
    """(row, pattern of paths, number of axes, unit) of each array of the table; a unit of None is any."""
    groups = {}
    for line in lines:
        if found := re.match(r"- `([A-Z]+)`: ([^;]*);", line):
            groups[found[1]] = re.findall("`([^`]+)`", found[2])
        if not line.startswith("| `"):
            continue
        path, shape, unit, meaning, when = (cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1])
        path, sparse, axes = path.strip("`"), shape.startswith("sparse: "), shape.count("×") + 1
        assert meaning and when, path
        first, _, rest = path.partition("/")
        for place in [f"{group}/{rest}" for group in groups[first]] if first else [path]:
            if sparse:
                assert axes == 2, path
                for part, count in PARTS.items():
                    yield f"{path}/{part}", pattern(place, f"/{part}"), count, unit if part == "data" else "1"
            else:
                yield path, pattern(place), 0 if shape == "scalar" else axes, unit


def arrays(file):
    """Path, number of axes, unit of all arrays; those of the last step once."""
    found = []

    def visit(group, path):
        for name in group:
            if path == "" and name in LINKS:
                last = sorted(group["steps"], key=int)[-1]
                assert group[name] == group["steps"][last][name], name
                continue
            item, own = group[name], f"{path}/{name}"
            if isinstance(item, h5py.Group):
                visit(item, own)
                continue
            assert len(text(item.attrs["meaning"])) > 0, own
            assert item.shape == () or len(item.attrs["axes"]) == item.ndim, own
            found.append((own, item.ndim, text(item.attrs["unit"])))

    visit(file, "")
    return found


with open(sys.argv[1], encoding="utf-8") as table:
    described = list(rows(table.read().splitlines()))


@functools.cache
def rows_of(path):
    return [row for row in described if row[1].fullmatch(path)]


wrong, used, count = set(), set(), 0
for name in sys.argv[2:]:
    with h5py.File(name) as file:
        for path, axes, unit in arrays(file):
            count += 1
            own = rows_of(path)
            if len(own) != 1:
                wrong.add(f"{path} of {name} has {len(own)} rows")
            for row in own:
                used.add(row[0])
                if (axes, unit) != row[2:]:
                    wrong.add(f"{path} of {name} has {axes} axes and the unit {unit}, row {row[0]} {row[2]} and {row[3]}")
wrong |= {f"{row[0]} is in no file" for row in described if row[0] not in used}
print("\n".join(sorted(wrong)) or f"{count} arrays are those of {len(used)} rows")
sys.exit(bool(wrong))
