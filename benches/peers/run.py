"""Runs steklov and the peers in turn on the two contact references and draws the work-precision chart.

usage: run.py [--only CODE]... [--problem NAME]... [--quick] [--threads N] [--out FOLDER] [--steklov PROGRAM]
Every run is a line of FOLDER/runs.jsonl; chart.py makes the rest from that file.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import chart
from problems import PROBLEMS
from settings import PEERS, plan

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
# a process may take so long, all included
TIMEOUT = 60
# the timed part of an adaptive loop ends after so long, round by round: the later rounds repeat the short runs
SECONDS = (12.0, 2.0, 2.0)
PROGRAMS = {"NGSolve": "peer_ngsolve.py", "scikit-fem": "peer_skfem.py", "GetFEM": "peer_getfem.py"}
# Debian's package serves Debian's Python only
PYTHONS = {"GetFEM": "/usr/bin/python3"}


def environment(threads):
    """So many threads for whatever asks; the programs of the peers read the first."""
    return {**os.environ, **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), str(threads))}


def output(*command):
    """What a command prints, None if it cannot be run."""
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None


def versions(steklov):
    """Version of each code, None for one that is missing."""
    package = "import importlib.metadata as m; print(m.version('{}'))"
    getfem = output(PYTHONS["GetFEM"], "-c", "import getfem") is not None
    debian = "dpkg-query", "--show", "--showformat", "${Version}", "python3-getfem"
    return {
        "steklov": (output(str(steklov), "--version") or "").removeprefix("steklov ") or None,
        "NGSolve": output(sys.executable, "-c", package.format("ngsolve")),
        "scikit-fem": output(sys.executable, "-c", package.format("scikit-fem")),
        "GetFEM": (output(*debian) or "unknown version") if getfem else None,
    }


def processor():
    """The processor's name and the number of cores."""
    text = Path("/proc/cpuinfo").read_text()
    names = [line.split(":")[1].strip() for line in text.splitlines() if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {os.cpu_count()} cores"


def run_steklov(program, problem, setting, threads):
    """One record: the whole process by the clock, and steklov's own total."""
    changes = [item for key, value in setting.items() for item in ("--set", f"{key}={value}")]
    with tempfile.TemporaryDirectory() as folder:
        result = ["--out", f"{folder}/result.vtkhdf", "--threads", str(threads), "--json", "--quiet"]
        command = [str(program), "solve", str(ROOT / "scenes" / f"{problem.name}.toml"), *result, *changes]
        start = time.perf_counter()
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT)
        except subprocess.TimeoutExpired:
            return [dict(mesh=0, failure=f"over {TIMEOUT} s")]
        seconds = time.perf_counter() - start
    try:
        answer = json.loads(done.stdout)
    except json.JSONDecodeError:
        return [dict(mesh=0, failure="refused", message=done.stderr.strip())]
    record = dict(mesh=0, seconds=seconds, own_seconds=answer["seconds"]["total"], energy=answer["energy"])
    record.update({key: answer[key] for key in ("dofs", "steps", "iterations", "estimate_relative", "reason")})
    return [record if answer["converged"] else dict(record, failure=answer["reason"])]


def run_peer(code, problem, setting, threads, seconds):
    """A record for each mesh; the last one names the failure if there is one."""
    program = [PYTHONS.get(code, sys.executable), str(HERE / PROGRAMS[code])]
    command = [*program, problem.name, json.dumps(dict(setting, seconds=seconds))]
    pipe = subprocess.PIPE
    child = subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=environment(threads))
    try:
        out, errors = child.communicate(timeout=TIMEOUT)
        failure = f"exit {child.returncode}" if child.returncode else None
    except subprocess.TimeoutExpired:
        child.kill()
        out, errors = child.communicate()
        failure = f"over {TIMEOUT} s"
    lines = [line for line in out.splitlines() if line.startswith("{") and line.endswith("}")]
    records = [dict(json.loads(line), mesh=i) for i, line in enumerate(lines)]
    if records and not records[-1]["converged"]:
        records[-1]["failure"] = "no convergence"
    elif failure:
        records.append(dict(mesh=len(records), failure=failure, message=errors[-500:]))
    return records


def turns(codes, problems, quick):
    """All runs of a round, the codes in turn and each spread over the whole round."""
    for problem in problems:
        lists = {code: plan(code, problem, quick) for code in codes}
        spread = [(i / len(pairs), code, pair) for code, pairs in lists.items() for i, pair in enumerate(pairs)]
        yield from ((code, problem, *pair) for _, code, pair in sorted(spread, key=lambda item: item[0]))


def main():
    names = {code.lower(): code for code in ("steklov", *PEERS)}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", choices=list(names))
    parser.add_argument("--problem", action="append", choices=list(PROBLEMS))
    parser.add_argument(
        "--quick", action="store_true", help="one round, two seconds a setting, one setting of each family"
    )
    parser.add_argument("--threads", type=int, default=2, help="threads of every code (default 2)")
    parser.add_argument("--out", type=Path, default=ROOT / "target" / "peers")
    parser.add_argument("--steklov", type=Path, default=ROOT / "target" / "release" / "steklov")
    options = parser.parse_args()
    found = versions(options.steklov)
    wanted = [names[name] for name in options.only or names]
    codes = [code for code in wanted if found[code]]
    problems = [PROBLEMS[name] for name in options.problem or PROBLEMS]
    options.out.mkdir(parents=True, exist_ok=True)
    with open(options.out / "runs.jsonl", "w") as lines:

        def put(record):
            lines.write(json.dumps(record) + "\n")
            lines.flush()

        load = os.getloadavg()[0]
        put(dict(processor=processor(), threads=options.threads, versions=found, load=load))
        if load > 0.5:
            print(f"the machine is busy (load {load:.1f}): NGSolve's seconds will be far too large", file=sys.stderr)
        slow = set()
        for number, seconds in enumerate(SECONDS[-1:] if options.quick else SECONDS):
            for code, problem, family, setting in turns(codes, problems, options.quick):
                key = code, problem.name, json.dumps(setting)
                if key in slow:
                    continue
                if code == "steklov":
                    records = run_steklov(options.steklov, problem, setting, options.threads)
                else:
                    records = run_peer(code, problem, setting, options.threads, seconds)
                common = dict(code=code, problem=problem.name, family=family, setting=setting, round=number)
                for record in records:
                    put(dict(common, **record))
                # long single solves are not repeated
                if not setting.get("theta") and records and records[-1].get("seconds", TIMEOUT) > SECONDS[-1]:
                    slow.add(key)
                print(f"round {number + 1}: {code}, {problem.name}, {family}, {len(records)} meshes", file=sys.stderr)
        put(dict(load=os.getloadavg()[0]))
    chart.main(options.out)


if __name__ == "__main__":
    main()
