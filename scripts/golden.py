"""All numbers of the gallery and of one study of each kind, compared with those kept in golden/.

A record is a JSON object: a line for each number of the printed JSON, for each dataset of the HDF5 file (shape, hash of its bits and
attributes, mean and norm) and for each picture, table and text (hash). Seconds and memory are left out.
"""

import concurrent.futures
import csv
import hashlib
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMMAND = ROOT / "target/release/steklov"
KEPT = ROOT / "golden"
# Numbers may differ so much, relative to the largest beside them, before they are others.
SAME = 1e-9
# What depends on the machine and the hour.
PASSING = ("second", "memory", "_bytes", "threads", "program", "fnv1a")
STUDIES = {
    "study-strategies": ("19-l-shape", ["--strategies", "uniform-h,h,hp", "--set", "method.max_dofs=200"]),
    "study-contact": ("block-on-floor", ["--multipliers", "biorthogonal,stabilised", "--strategies", "h,hp", "--set", "method.max_dofs=130"]),
    "study-stability": ("08-contact-patch", ["--what", "stability"]),
    "study-inf-sup": ("block-on-floor", ["--what", "inf-sup", "--set", "method.max_dofs=128"]),
    "study-stochastic": ("31-random-load-and-modulus", ["--what", "stochastic", "--set", "method.max_dofs=140"]),
    "study-multiscale": ("33-bar-of-random-cells", ["--what", "multiscale"]),
    "study-quantities": ("76-numbers-by-names", ["--what", "quantities", "--set", "method.tolerance=1e-2"]),
    "study-coupling": ("40-transmission", ["--what", "coupling", "--set", "method.max_dofs=1200"]),
}
PICTURED = ("15-block-on-floor", "20-crack", "30-rough-obstacle", "35-checkerboard", "41-random-cells-in-a-medium", "45-tunnel", "48-shrink-fit-square")
QUICK = ("07-kirsch", "11-two-walls", "15-block-on-floor", "19-l-shape", "23-stick-and-slip", "26-ssnv128", "29-random-modulus", "34-laminate",
         "40-transmission", "44-kirsch-in-the-plane", "48-shrink-fit-square", "study-strategies")


def passes(name):
    return any(word in name for word in PASSING) or name.startswith("cost")


def digest(*parts):
    whole = hashlib.sha256()
    for part in parts:
        whole.update(part if isinstance(part, bytes) else str(part).encode())
    return whole.hexdigest()[:12]


def flattened(value, path, lines):
    """The numbers and words of a JSON value by their paths."""
    if isinstance(value, dict):
        for key, inner in value.items():
            inner_path = f"{path}.{key}" if path else key
            if not passes(inner_path) and key not in ("file", "files"):
                flattened(inner, inner_path, lines)
    elif isinstance(value, list):
        for k, inner in enumerate(value):
            flattened(inner, f"{path}.{k}", lines)
    else:
        lines[path] = value


def text_of(name, text):
    """A stored text without what passes."""
    if name.endswith("plan"):
        text = "\n".join(line for line in text.splitlines() if "largest mesh" not in line)
    return text


def of_dataset(name, data):
    attributes = sorted((k, np.asarray(v).tobytes()) for k, v in data.attrs.items() if not passes(k))
    value = data[()]
    if isinstance(value, bytes):
        return {"text": digest(*attributes, text_of(name, value.decode()))}
    value = np.asarray(value)
    line = {"of": f"{value.dtype} {list(value.shape)}", "hash": digest(*attributes, value.dtype, value.shape, value.tobytes())}
    if value.dtype.kind in "fiu" and value.size:
        finite = np.where(np.isfinite(value), value, 0.0).astype(float)
        line["mean"], line["norm"] = float(finite.mean()), float(np.linalg.norm(finite))
        line["finite"] = int(np.isfinite(value).sum())
    return line


def of_file(path):
    lines = {}

    def look(name, item):
        if passes(name) or name == "summary":
            return
        if isinstance(item, h5py.Dataset):
            lines[name] = of_dataset(name, item)
        elif item.attrs:
            lines[name] = {"attributes": digest(*sorted((k, np.asarray(v).tobytes()) for k, v in item.attrs.items() if not passes(k)))}

    with h5py.File(path) as file:
        file.visititems(look)
    return lines


def of_table(path):
    rows = list(csv.reader(path.open()))
    kept = [k for k, name in enumerate(rows[0]) if not passes(name)]
    return {"table": digest(*[",".join(row[k] for k in kept if k < len(row)) for row in rows])}


def run(arguments, folder):
    ran = subprocess.run([COMMAND, *arguments], cwd=folder, capture_output=True, text=True)
    if ran.returncode not in (0, 3):
        sys.exit(f"{' '.join(map(str, arguments))}: status {ran.returncode}\n{ran.stderr}")
    return ran.returncode, ran.stdout


def record(name):
    """What a scene or a study gives."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        if name in STUDIES:
            scene, arguments = STUDIES[name]
            arguments = ["study", ROOT / f"scenes/{scene}.toml", "--repeat", "1", "--out", "out", "--json", "--quiet", *arguments]
        else:
            plots = ["--plots", "out"] if name in PICTURED else []
            arguments = ["solve", ROOT / f"scenes/{name}.toml", "--out", "out.vtkhdf", "--json", "--quiet", *plots]
        status, printed = run(arguments, folder)
        lines, files = {"status": status}, {}
        flattened(json.loads(printed), "", lines)
        for path in sorted(folder.rglob("*")):
            inner = str(path.relative_to(folder))
            if passes(path.name):
                continue
            if path.suffix in (".h5", ".vtkhdf"):
                files.update({f"{inner}:{k}": v for k, v in of_file(path).items()})
            elif path.suffix == ".csv":
                files[inner] = of_table(path)
            elif path.suffix == ".svg":
                files[inner] = {"picture": digest(path.read_bytes())}
    return {"printed": lines, "files": files}


def written(new):
    """A line for each number, dataset and file."""
    part = lambda lines: ",\n".join(f"{json.dumps(k)}: {json.dumps(v, ensure_ascii=False)}" for k, v in lines.items())
    return "{\n" + ",\n".join(f'"{name}": {{\n{part(lines)}\n}}' for name, lines in new.items()) + "\n}\n"


def neighbours(lines):
    """The largest number beside each."""
    largest = {}
    for path, value in lines.items():
        if isinstance(value, float):
            parent = path.rpartition(".")[0]
            largest[parent] = max(largest.get(parent, 0.0), abs(value))
    return largest


def other(a, b, beside=0.0):
    """Whether two values are not the same within SAME; None where only their bits differ."""
    if a == b or a is b:
        return False
    numbers = [isinstance(v, (int, float)) and not isinstance(v, bool) for v in (a, b)]
    if not all(numbers):
        return True
    close = abs(a - b) <= SAME * max(abs(a), abs(b), beside) or math.isnan(a) and math.isnan(b)
    return None if close else True


def compared(old, new):
    """Places where numbers differ, and where only bits do."""
    numbers, bits = [], []
    beside = neighbours(old["printed"])
    for path in sorted(old["printed"].keys() | new["printed"].keys()):
        a, b = old["printed"].get(path, "not there"), new["printed"].get(path, "not there")
        differs = other(a, b, beside.get(path.rpartition(".")[0], 0.0) if isinstance(a, float) else 0.0)
        if differs is not False:
            (numbers if differs else bits).append(f"{path}: {a} is {b}")
    for path in sorted(old["files"].keys() | new["files"].keys()):
        a, b = old["files"].get(path, {}), new["files"].get(path, {})
        # mean and norm of the same bits are rounded otherwise on other machines
        if a == b or "hash" in a and (a["hash"], a["of"]) == (b.get("hash"), b.get("of")):
            continue
        told = [key for key in ("of", "mean", "norm", "finite") if other(a.get(key), b.get(key), a.get("norm") or 0.0) is True]
        line = f"{path}: {a} is {b}"
        only_bits = "hash" in a and "hash" in b and not told and a["of"].startswith("float")
        (bits if only_bits else numbers).append(line)
    return numbers, bits


def main(arguments):
    flags = {a for a in arguments if a.startswith("--")}
    if unknown := flags - {"--quick", "--bits", "--keep"}:
        sys.exit(f"{' '.join(unknown)}: not known; --quick, --bits, --keep")
    scenes = sorted(path.stem for path in (ROOT / "scenes").glob("*.toml"))
    names = [a for a in arguments if a not in flags] or (list(QUICK) if "--quick" in flags else scenes + list(STUDIES))
    if unknown := set(names) - set(scenes) - set(STUDIES):
        sys.exit(f"{' '.join(unknown)}: neither a scene of the gallery nor a study of {', '.join(STUDIES)}")
    KEPT.mkdir(exist_ok=True)
    failed = same = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, new in zip(names, pool.map(record, names)):
            path = KEPT / f"{name}.json"
            if "--keep" in flags:
                path.write_text(written(new))
                continue
            if not path.exists():
                sys.exit(f"{path} is not there: scripts/golden --keep {name}")
            numbers, bits = compared(json.loads(path.read_text()), new)
            same += not numbers and not bits
            wrong = numbers + bits if "--bits" in flags else numbers
            failed += bool(wrong)
            if numbers or bits:
                print(f"{name}: {len(numbers)} other numbers, {len(bits)} equal ones with other bits")
                print("".join(f"  {line}\n" for line in (wrong or bits)[:8]), end="")
    print(f"{len(names)} records, {same} with the same bits, {failed} failed")
    sys.exit(failed > 0)


main(sys.argv[1:])
