"""The package beside the command, whose path is in STEKLOV, and the root of the repository in ROOT."""

import json
import os
import pathlib
import re
import resource
import signal
import subprocess
import threading
import time

import numpy
import pytest

import steklov

ROOT = pathlib.Path(os.environ["ROOT"])
BLOCK = {
    "title": "block",
    "body": {"corners": [[0, 0], [2, 0], [2, 1], [0, 1]], "sides": ["floor", "right", "top", "left"]},
    "material": {"young": 200, "poisson": 0.3},
    "parameters": {"p": 1.0, "F": 0.1, "q": "F/2"},
    "sides": {"floor": {"contact": {"gap": "0", "friction": {"tresca": "F"}}}, "top": {"traction": ["q", "-p"]}},
}
TIMES = ("seconds", "peak_memory_bytes", "file")


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(entry) for key, entry in value.items() if key not in TIMES}
    return [without_times(entry) for entry in value] if isinstance(value, list) else value


def command(*arguments):
    ran = subprocess.run([os.environ["STEKLOV"], *arguments], capture_output=True, text=True)
    assert ran.returncode in (0, 3), ran.stderr
    return json.loads(ran.stdout)


@pytest.mark.parametrize("scene", ["block-on-floor", "25-coulomb-wedge", "60-two-cylinders", "39-weight-that-varies", "29-random-modulus"])
def test_numbers_are_those_of_the_command_to_the_bit(scene, tmp_path):
    path, out = ROOT / "scenes" / f"{scene}.toml", tmp_path / "result.vtkhdf"
    told = command("solve", str(path), "--json", "--quiet", "--out", str(out), "--set", "method.tolerance=1e-2")
    result = steklov.solve(path, method__tolerance=1e-2)
    assert without_times(result.summary) == without_times(told)
    assert result.quantities["energy"] == told["energy"]
    h5py = pytest.importorskip("h5py")
    with h5py.File(out) as file:
        if "contact" in file:
            names = {"points": "point", "pressure": "pressure", "shear": "shear", "gap": "gap", "status": "status", "weight": "weight"}
            for stored, own in names.items():
                assert numpy.array_equal(file["contact"][stored][()], result.contact[own]), stored


def test_a_dictionary_is_the_text_that_it_means():
    text, name = steklov.text_of(BLOCK)
    assert name == "scene" and steklov.text_of(text) == (text, "scene")
    a, b = steklov.solve(BLOCK), steklov.solve(text)
    assert without_times(a.summary) == without_times(b.summary)
    # names that are no bare keys, numbers of numpy, order of parameters
    scene = dict(BLOCK, material={"young": numpy.float64(200), "poisson": numpy.float32(0.25)})
    scene["body"] = dict(BLOCK["body"], corners=numpy.array(BLOCK["body"]["corners"]))
    assert steklov.solve(scene, **{"material.poisson": 0.3}).summary["energy"] == a.summary["energy"]
    scene = dict(BLOCK, parameters={"p__0": 1.0, "F": 0.1, "q": "F/2"})
    scene["sides"] = dict(BLOCK["sides"], top={"traction": ["q", "-p__0"]})
    assert abs(steklov.solve(scene, **{"parameters.p__0": 2.0}).quantities["contact.force.y"] - 4) < 1e-9


def test_overrides_change_keys_and_quantities_are_a_mapping():
    result = steklov.solve(BLOCK, parameters__p=3)
    assert abs(result.quantities["contact.force.y"] - 6) < 1e-9 and result.converged
    assert set(result.quantities) >= {"energy", "contact.length", "reactions.floor.y"}
    series = result.quantities.series("three")
    assert series.name == "three" and series["energy"] == result.summary["energy"]
    with pytest.raises(KeyError, match="did you mean 'contact.force.y'"):
        result.quantities["contact.fource.y"]
    value, uncertainty = result.energy
    assert abs(value - result.summary["energy"]) <= 10 * uncertainty + 1e-12


def test_plans_solve_nothing():
    plan = steklov.plan(BLOCK, method__elements=24)
    assert plan["model"] == "bem" and plan["cost"]["elements"] == 24


@pytest.mark.parametrize(
    "change, error, told",
    [
        ({"material__yuong": 1}, steklov.SceneError, "did you mean young"),
        ({"parameters__r": 1.0}, steklov.SceneError, "no expression uses r"),
        ({"material__young": -1.0}, steklov.SceneError, "positive"),
        ({"sides__floor": {}}, steklov.SceneError, "hold a side"),
        ({"parameters__p": float("nan")}, ValueError, "parameters__p is nan"),
        ({"sides__top": {"pressure": lambda x: x}}, TypeError, "sides__top.pressure is a function"),
        ({"body__corners": [[0, 0], [1, None]]}, TypeError, r"body__corners\[1\]\[1\]"),
    ],
)
def test_what_is_wrong_is_an_exception_with_a_remedy(change, error, told):
    with pytest.raises(error, match=told):
        steklov.solve(BLOCK, **change)


def test_errors_have_their_parts():
    with pytest.raises(steklov.SteklovError) as caught:
        steklov.solve(steklov.text_of(BLOCK)[0].replace("young", "yuong"))
    assert caught.value.line == 3 and "young" in caught.value.help and "yuong" in caught.value.message
    with pytest.raises(FileNotFoundError):
        steklov.solve("nowhere.toml")


def test_progress_is_told_and_its_errors_end_the_solution():
    told = []
    steklov.solve(BLOCK, progress=lambda text, share: told.append((text, share)))
    assert told[0][0].startswith("step 1: ") and all(0 <= share <= 1 for _, share in told)
    with pytest.raises(ZeroDivisionError):
        steklov.solve(BLOCK, progress=lambda text, share: 1 / 0)


LONG = {"method__tolerance": 1e-9, "method__refine": "uniform-h", "method__max_dofs": 100000}


def test_an_interrupt_ends_a_solution_and_other_threads_run_meanwhile():
    counted, running = [0], [True]

    def count():
        while running[0]:
            counted[0] += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        steklov.solve(ROOT / "scenes" / "block-on-floor.toml", **LONG)
    running[0] = False
    counter.join()
    assert counted[0] > 20


def test_many_solutions_take_no_more_memory():
    def grown(count):
        for k in range(count):
            steklov.solve(BLOCK, parameters__p=1 + k / 100)
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before = grown(50)
    assert grown(200) - before < 8 * 1024


def test_the_program_of_the_guide_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "guide" / "python.md").read_text(encoding="utf-8")
    names = {}
    blocks = re.findall(r"```python\n(.*?)```", page, re.S)
    assert len(blocks) > 3
    for block in blocks:
        exec(compile(block, "python.md", "exec"), names)
