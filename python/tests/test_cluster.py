"""Points and outcomes by the workers of a Dask cluster, beside those of one process."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import numpy
import pytest

import steklov

distributed = pytest.importorskip("distributed")
ROOT = pathlib.Path(os.environ["ROOT"])
SCENE = ROOT / "scenes" / "29-random-modulus.toml"
TIMES = ("seconds", "peak_memory_bytes", "file")


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(entry) for key, entry in value.items() if key not in TIMES}
    return [without_times(entry) for entry in value] if isinstance(value, list) else value


@pytest.fixture(scope="module")
def client():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, distributed.Client(cluster) as client:
        yield client


def killer_of_a_worker(client):
    """A function that kills a worker of the cluster."""
    pid = next(iter(client.run(os.getpid).values()))
    return lambda: os.kill(pid, signal.SIGKILL)


def test_points_have_the_bits_of_one_process_and_a_dead_worker_is_replaced(client):
    vary, settings = {"material.young": numpy.linspace(1, 2, 24)}, {"method__tolerance": 1e-3}
    path = ROOT / "scenes" / "block-on-floor.toml"
    alone = steklov.sweep(path, vary, **settings)
    kill, told = killer_of_a_worker(client), []

    def progress(text, share):
        if not told:
            assert share < 1
            kill()
        told.append(share)

    shared = steklov.sweep(path, vary, client=client, progress=progress, **settings)
    assert shared.summaries == alone.summaries and told[-1] == 1.0 and told == sorted(told)
    with pytest.raises(steklov.SceneError, match="materials.young") as refused:
        steklov.sweep(path, {"materials.young": [1, 2]}, client=client)
    assert refused.value.help


@pytest.mark.parametrize("method", ["monte-carlo", "sparse", "corrected"])
def test_outcomes_have_the_bits_of_one_process(client, method):
    settings = {"method__tolerance": 1e-2, "stochastic": {"method": method, **({"samples": 1000} if method == "monte-carlo" else {})}}
    alone = steklov.solve(SCENE, **settings)
    shared = steklov.solve(SCENE, client=client, **settings)
    assert json.dumps(without_times(alone.summary)) == json.dumps(without_times(shared.summary))


RANDOM = {"p": {"distribution": "uniform", "low": 0.5, "high": 1.5}}
SAMPLES = {"method": "monte-carlo", "samples": 100}
PLATE = {"corners": [[0, 0], [2, 0], [2, 1], [0, 1]], "sides": ["floor", "right", "top", "left"]}
REFINED = {
    "curves": {
        "body": {**PLATE, "holes": [{"circle": {"centre": [1, 0.5], "radius": 0.2}, "side": "hole"}]},
        "material": {"young": 1000, "poisson": 0.3},
        "sides": {"left": {"displacement": [0, 0]}, "hole": {"traction": ["0", "-p*y"]}, "right": {"traction": [0, "1 + p"]}},
        "method": {"tolerance": 1e-3},
    },
    "coarse cells": {
        "body": PLATE,
        "material": {"poisson": 0.3, "cells": {"size": 0.125, "young": "100 + 900*if((8*x - 0.5)^2 < 4, 1, 0)"}},
        "sides": {"left": {"displacement": [0, 0]}, "right": {"traction": [0, "p"]}},
        "grid": {"coarse": [4, 2], "fine": [8, 8]},
        "method": {"model": "msfem", "tolerance": 1e-1},
    },
}


@pytest.mark.parametrize("name", REFINED)
def test_outcomes_on_refined_meshes_have_the_bits_of_one_process(client, name):
    scene = {**REFINED[name], "random": RANDOM, "stochastic": SAMPLES}
    alone, shared = steklov.solve(scene), steklov.solve(scene, client=client)
    assert alone.summary["steps"] > 1
    assert json.dumps(without_times(alone.summary)) == json.dumps(without_times(shared.summary))


def test_workers_in_the_same_process_do_not_wait_for_its_only_thread():
    program = f"""
import os
os.sched_setaffinity(0, [next(iter(os.sched_getaffinity(0)))])
import distributed, steklov
with distributed.Client(processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None) as client:
    result = steklov.solve({str(SCENE)!r}, client=client, method__tolerance=1e-1, stochastic={SAMPLES!r})
    print(result.summary["converged"])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert done.stdout == "True\n", done.stderr


def test_outcomes_are_complete_where_a_worker_dies(client):
    settings = {"method__tolerance": 1e-2, "stochastic": {"method": "monte-carlo", "samples": 1000}}
    timer = threading.Timer(0.7, killer_of_a_worker(client))
    timer.start()
    shared = steklov.solve(SCENE, client=client, **settings)
    timer.join()
    assert json.dumps(without_times(steklov.solve(SCENE, **settings).summary)) == json.dumps(without_times(shared.summary))


def test_outcomes_that_cannot_be_divided_are_refused(client):
    with pytest.raises(steklov.SolveError, match="leave out client, or set stochastic.method"):
        steklov.solve(SCENE, client=client, stochastic__method="galerkin")
    with pytest.raises(steklov.SolveError, match="nothing of this scene is random"):
        steklov.solve(ROOT / "scenes" / "block-on-floor.toml", client=client)


def test_ctrl_c_ends_outcomes_on_a_cluster(client):
    timer = threading.Timer(1.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    clock = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        steklov.solve(SCENE, client=client, stochastic={"method": "monte-carlo", "samples": 100000})
    assert time.monotonic() - clock < 5


def test_files_of_a_scene_are_those_of_the_client_and_of_the_moment(client, tmp_path, monkeypatch):
    h5py = pytest.importorskip("h5py")
    scene = {
        "body": {"corners": [[0, 0], [2, 0], [2, 1], [0, 1]], "sides": ["floor", "right", "top", "left"]},
        "material": {"poisson": 0.3, "cells": {"size": 0.5, "young": {"file": "moduli.h5", "dataset": "young"}}},
        "random": {"p": {"distribution": "uniform", "low": 0.5, "high": 1.5}},
        "sides": {"floor": {"displacement": ["0", "0"]}, "top": {"pressure": "p"}},
        "grid": {"coarse": [4, 2], "fine": [2, 2]},
        "method": {"refine": "none"},
        "stochastic": {"method": "monte-carlo", "samples": 40},
    }
    monkeypatch.chdir(tmp_path)
    means = []
    for young in (50.0, 100.0):
        with h5py.File("moduli.h5", "w") as file:
            file["young"] = numpy.full((4, 2), young)
        alone, shared = steklov.solve(scene), steklov.solve(scene, client=client)
        assert json.dumps(without_times(alone.summary)) == json.dumps(without_times(shared.summary))
        means.append(shared.summary["stochastic"]["energy"]["mean"])
        vary = {"parameters.q": [1, 2]}
        points = {"parameters": {"q": 1}, "sides": {**scene["sides"], "top": {"pressure": "q"}}}
        flat = {key: value for key, value in {**scene, **points}.items() if key not in ("random", "stochastic")}
        assert steklov.sweep(flat, vary, client=client).summaries == steklov.sweep(flat, vary).summaries
    assert abs(means[0] / means[1] - 2) < 1e-9
