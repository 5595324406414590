"""The package beside the command, whose path is in STEKLOV, and the root of the repository in ROOT."""

import functools
import json
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
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


@functools.cache
def solved(scene):
    """A scene of the repository, roughly."""
    return steklov.solve(ROOT / "scenes" / f"{scene}.toml", method__tolerance=0.1)


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


def test_error_bars_hold_the_exact_numbers():
    # a bar under its own weight, u_y = -g (L y - y^2/2) / E
    bar = {
        "body": {"corners": [[0, 0], [1, 0], [1, 4], [0, 4]], "sides": ["foot", "right", "top", "left"]},
        "material": {"young": 100, "poisson": 0.0, "plane": "stress"},
        "sides": {"foot": {"displacement": ["free", 0]}},
        "body_force": {"value": ["0", "-3"]},
        "probe": {"points": [[0.5, 2]]},
    }
    for tolerance in [1e-1, 1e-3]:
        result = steklov.solve(bar, method__tolerance=tolerance)
        for path, exact in [("probe.0.displacement.y", -0.18), ("probe.0.stress.yy", -6.0), ("reactions.foot.y", 12.0)]:
            value, uncertainty, doubts = result.error_bars[path]
            assert value == result.quantities[path] and not doubts, (path, doubts)
            assert abs(value - exact) <= uncertainty < 1e-8, (path, value, uncertainty)
    assert result.quantities["quantities.reactions.foot.y.uncertainty"] == result.error_bars["reactions.foot.y"][1]


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

    before = grown(15)
    assert grown(45) - before < 2 * 1024


@pytest.mark.parametrize("name", ["python.md", "python-example.md"])
def test_the_program_of_the_guide_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "guide" / name).read_text(encoding="utf-8")
    names = {}
    blocks = re.findall(r"```python\n(.*?)```", page, re.S)
    assert len(blocks) > 3
    for block in blocks:
        exec(compile(block, name, "exec"), names)
    pictures = list(tmp_path.glob("*.png"))
    assert len(pictures) >= 3 and all(picture.stat().st_size > 5000 for picture in pictures)


@pytest.mark.parametrize("scene", ["07-kirsch", "11-two-walls", "47-circular-inclusion", "43-lining-in-rock", "45-tunnel", "73-round-lining", "34-laminate"])
def test_points_and_lines_have_the_bits_of_probes(scene):
    path = ROOT / "scenes" / f"{scene}.toml"
    first = solved(scene)
    points = numpy.array([p["point"] for p in first.summary["probe"]])
    line = [points[0], points.mean(axis=0) + 1e-3]
    side = first._solved.sides()[0]
    probe = {"points": points, "lines": [{"from": line[0], "to": line[1], "points": 5}], "sides": [side]}
    result = steklov.solve(path, method__tolerance=0.1, probe=probe)
    for name, own in result.at(points).items():
        if name in ("displacement", "stress"):
            told = [[numpy.nan if v is None else v for v in p[name]] for p in result.summary["probe"]]
            assert numpy.array_equal(own, told, equal_nan=True), name
    for told, own in [(result.summary["probe_lines"][0]["points"], result.along(line, 5)), (result.summary["probe_sides"][0]["points"], result.along(side))]:
        assert len(told) == len(own["s"])
        for name, column in own.items():
            values = [point.get(name) for point in told]
            if name in ("body", "stress_unbounded"):
                assert [v or None for v in values] == [v or None for v in column]
            else:
                values = numpy.array(values, dtype=float)
                assert numpy.array_equal(values, column, equal_nan=True), name


def test_points_have_any_shape_and_places_without_a_body_are_nan():
    result = steklov.solve(BLOCK)
    x, y = numpy.meshgrid([0.5, 1.0, 5.0], [0.25, 0.75])
    found = result.at(numpy.stack([x, y], axis=-1))
    assert found["displacement"].shape == (2, 3, 2) and found["stress"].shape == (2, 3, 3) and found["von_mises"].shape == (2, 3)
    assert numpy.isnan(found["stress"]).all(axis=-1).tolist() == [[False, False, True]] * 2
    smooth = steklov.solve(BLOCK, parameters__F=0)
    assert abs(smooth.at([1.0, 0.5])["stress"][1] + 1) < 1e-9, "a point alone has no axis of its own"
    assert result.at(numpy.zeros((0, 2)))["von_mises"].shape == (0,)
    edge = smooth.along("top")
    assert numpy.allclose(edge["normal_traction"], -1, atol=1e-9) and numpy.allclose(edge["normal"], [0, 1])
    for wrong, error, word in [([[0, 0, 0]], ValueError, "(1, 3)"), ([[0, numpy.nan]], ValueError, "nowhere"), (3.0, ValueError, "shape")]:
        with pytest.raises(error, match=re.escape(word)):
            result.at(wrong)
    with pytest.raises(KeyError, match="did you mean 'top'"):
        result.along("tap")
    with pytest.raises(ValueError, match="two points"):
        result.along([0, 1])
    for line, count, word in [([[0, 0], [1, 1]], 1, "from 2 to"), ([[5, 5], [6, 6]], 9, "none of the 9 points"), ([[1, 1], [1, 1]], 9, "no length")]:
        with pytest.raises(ValueError, match=word):
            result.along(line, count)


def test_interfaces_have_tables():
    result = steklov.solve(ROOT / "scenes" / "60-two-cylinders.toml", method__tolerance=1e-2)
    assert list(result.interfaces) == [entry["name"] for entry in result.summary["interfaces"]]
    for entry in result.summary["interfaces"]:
        table = result.interfaces[entry["name"]]
        force = (table["weight"] * table["pressure"]).sum() if entry["kind"] == "contact" else (table["weight"][:, None] * table["traction"]).sum(axis=0)
        assert numpy.isclose(numpy.linalg.norm(force), numpy.linalg.norm(entry["force"]), rtol=0.05)


@pytest.mark.parametrize("scene", ["07-kirsch", "43-lining-in-rock", "59-tied-blocks", "33-bar-of-random-cells", "29-random-modulus"])
def test_fields_and_saved_files_have_the_bits_of_the_command(scene, tmp_path):
    h5py = pytest.importorskip("h5py")
    path, out, own = ROOT / "scenes" / f"{scene}.toml", tmp_path / "result.vtkhdf", tmp_path / "own.vtkhdf"
    command("solve", str(path), "--json", "--quiet", "--out", str(out), "--set", "method.tolerance=0.1")
    result = solved(scene)
    result.save(own)
    with pytest.raises(OSError, match="replace=True"):
        result.save(own)
    result.save(own, replace=True)
    fields = result.fields
    with h5py.File(out) as told, h5py.File(own) as file:
        names = []
        told.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        for name in names:
            if name not in ("summary",) and "seconds" not in name:
                assert told[name][()].tobytes() == file[name][()].tobytes(), name
        assert set(names) == set(filter(lambda name: isinstance(file[name], h5py.Dataset), all_names(file)))
        vtk = told["VTKHDF"]
        assert numpy.array_equal(vtk["Points"][()][:, :2], fields["points"])
        cells = [fields[kind].ravel() for kind in ("lines", "triangles", "quads")]
        assert numpy.array_equal(vtk["Connectivity"][()], numpy.concatenate(cells))
        for group, data in [("PointData", fields["point_data"]), ("CellData", fields["cell_data"])]:
            assert set(vtk.get(group, {})) - {"part"} == set(data)
            for name, values in data.items():
                assert numpy.array_equal(vtk[group][name][()], values, equal_nan=True), name


def all_names(file):
    names = []
    file.visit(names.append)
    return names


def test_pictures_are_drawn(tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as pyplot

    for scene, fields in [("07-kirsch", ["von_mises", "xx", "displacement", "uy"]), ("34-laminate", ["von_mises", "young", "xy"])]:
        result = solved(scene)
        for field in fields:
            result.plot(field).figure.savefig(tmp_path / f"{scene}-{field}.png")
            assert (tmp_path / f"{scene}-{field}.png").stat().st_size > 5000
        with pytest.raises(KeyError, match="von_mises"):
            result.plot("von_misses")
        with pytest.raises(ValueError, match="nothing of this scene is in contact"):
            result.plot_contact()
        pyplot.close("all")
    axes = steklov.solve(BLOCK).plot_contact()
    assert axes.get_lines()[0].get_label() == "pressure on floor"
    pyplot.close("all")


def test_pyvista_has_the_fields():
    pyvista = pytest.importorskip("pyvista")
    result = solved("34-laminate")
    grid = result.to_pyvista()
    assert grid.n_cells == sum(len(result.fields[kind]) for kind in ("lines", "triangles", "quads"))
    area = grid.threshold(0.5, scalars="part").compute_cell_sizes()["Area"].sum()
    outline = numpy.ptp(result.fields["points"], axis=0)
    assert abs(area / outline.prod() - 1) < 1e-12
    assert numpy.array_equal(grid.cell_data["young"], result.fields["cell_data"]["young"])


def test_a_sweep_has_the_bits_of_single_solutions_and_of_the_command(tmp_path):
    loads = numpy.linspace(0.5, 2, 4)
    told = []
    swept = steklov.sweep(BLOCK, {"parameters.p": loads, "method__refine": ["h", "hp"]}, progress=lambda text, share: told.append((text, share)), method__tolerance=1e-2)
    assert len(swept) == 8 and told[-1] == ("points 8 of 8", 1.0) and swept.keys == ["parameters.p", "method.refine"]
    for (p, refine), summary in zip(swept.points, swept.summaries):
        alone = steklov.solve(BLOCK, parameters__p=p, method__refine=refine, method__tolerance=1e-2)
        assert without_times(summary) == without_times(alone.summary)
    assert numpy.array_equal(swept["parameters.p"], numpy.repeat(loads, 2)) and numpy.allclose(swept["contact.force.y"], 2 * swept["parameters.p"])
    frame = swept.frame()
    assert frame["converged"].all() and list(frame["method.refine"]) == ["h", "hp"] * 4
    path = tmp_path / "block.toml"
    path.write_text(steklov.text_of(BLOCK)[0], encoding="utf-8")
    out, own = tmp_path / "own.h5", tmp_path / "python.h5"
    command("sweep", str(path), "--vary", "parameters.p=" + ",".join(map(repr, loads.tolist())), "--vary", "method.refine=h,hp", "--set", "method.tolerance=0.01", "--out", str(out), "--json", "--quiet")
    swept.save(own)
    assert own.read_bytes() == out.read_bytes()
    assert swept.csv() == out.with_suffix(".csv").read_text(encoding="utf-8")


def test_points_of_a_sweep_may_fail_and_wrong_ones_are_refused():
    pandas = pytest.importorskip("pandas")
    swept = steklov.sweep(BLOCK, points=pandas.DataFrame({"material.poisson": [0.2, 0.7], "parameters.p": [1, 2]}))
    assert swept.summaries[1] is None and "Poisson" in swept.messages[1] and numpy.isnan(swept["energy"][1])
    assert swept.converged.tolist() == [True, False]
    paired = steklov.sweep(BLOCK, {"parameters.p": [1, 2], "parameters.F": [0.1, 0.2]}, zip=True)
    assert paired.points == [(1, 0.1), (2, 0.2)]
    for arguments, error, word in [
        (dict(vary={"parameters.pp": [1]}), steklov.SceneError, "pp"),
        (dict(vary={"parameters.p": []}), ValueError, "no values"),
        (dict(vary={}), ValueError, "no keys"),
        (dict(vary={"parameters.p": 3}), TypeError, "list"),
        (dict(vary={"parameters.p": [1, 2], "parameters.F": [1]}, zip=True), ValueError, "as many values"),
        (dict(vary={"parameters.p": [1, float("nan")]}), ValueError, "parameters.p is nan"),
        (dict(vary={"parameters.p": [1], "parameters__p": [2]}), ValueError, "varied twice"),
        (dict(vary={"parameters.p": [1], 'parameters."p"': [2]}), ValueError, "varied twice"),
        (dict(vary={"parameters.p": [1], "parameters": [{"p": 2}]}), ValueError, "a part of the other"),
        (dict(vary={"parameters.p": range(10**9)}), ValueError, "take fewer"),
        (dict(vary={"parameters.p": [1]}, threads=0), ValueError, "1 or more"),
        (dict(points=[]), ValueError, "empty"),
        (dict(points=[{"parameters.p": 1}, {"parameters.F": 1}]), ValueError, "points[1]"),
        (dict(), TypeError, "either"),
        (dict(vary={"parameters.p": range(400), "parameters.F": numpy.linspace(0.1, 1, 300)}), ValueError, "all of them would take"),
        (dict(vary={"parameters.p": range(10**5), "parameters.F": range(10**5)}), ValueError, "1e+10 points"),
    ]:
        with pytest.raises(error, match=re.escape(word)):
            steklov.sweep(BLOCK, **arguments)
    with pytest.raises(KeyError, match="did you mean 'energy'"):
        swept["energi"]
    failed = steklov.sweep(BLOCK, {"material.poisson": [0.7, 0.8]})
    assert numpy.isnan(failed["energy"]).all() and failed["material.poisson"].tolist() == [0.7, 0.8]


def test_ctrl_c_ends_a_sweep():
    timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    clock = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        steklov.sweep(ROOT / "scenes" / "25-coulomb-wedge.toml", {"material.young": numpy.linspace(1, 2, 500)}, method__tolerance=1e-4)
    assert time.monotonic() - clock < 3


def test_progress_may_be_a_bar(capsys):
    steklov.solve(BLOCK, progress=True)
    steklov.sweep(BLOCK, {"parameters.p": [1, 2]}, progress=True)
    assert "points 2 of 2" in capsys.readouterr().err


def test_masks_by_the_names_of_sides_take_their_rows():
    result = steklov.solve(BLOCK)
    on_floor = result.contact["side"] == "floor"
    force = (result.contact["pressure"] * result.contact["weight"])[on_floor].sum()
    assert on_floor.all() and abs(force - 2) < 1e-9
    several = solved("59-tied-blocks")
    found = several.at([[1e9, 0.0], several.summary["probe"][0]["point"] if several.summary["probe"] else [0.5, 0.25]])
    assert found["body"][0] == "" and found["body"].dtype.kind == "U"


def test_a_forked_process_says_that_it_lacks_threads():
    code = f"""
import multiprocessing, steklov
scene = {str(ROOT / "scenes" / "block-on-floor.toml")!r}
def child(queue):
    try:
        steklov.solve(scene)
    except steklov.SolveError as error:
        queue.put(str(error))
result = steklov.solve(scene, method__tolerance=1e-2)
context = multiprocessing.get_context("fork")
queue = context.Queue()
process = context.Process(target=child, args=(queue,))
process.start()
print(queue.get(timeout=20))
process.join(20)
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert "lacks its threads" in ran.stdout and "spawn" in ran.stdout, ran.stderr


def test_paths_may_have_any_name(tmp_path):
    path = tmp_path / "load=3.toml"
    path.write_text(steklov.text_of(BLOCK)[0], encoding="utf-8")
    assert steklov.text_of(str(path))[1] == str(path)
