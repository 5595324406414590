"""Functions of Python as profiles of scenes, judged by the same functions as expressions, and by themselves where nothing was sampled."""

import math
import random

import numpy
import pytest

import steklov


def block(profile, gap="f(x)", **method):
    return {
        "body": {"corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "sides": ["floor", "right", "top", "left"]},
        "material": {"young": 200, "poisson": 0.3},
        "profiles": {"f": profile},
        "sides": {"floor": {"contact": {"gap": gap}}, "top": {"displacement": [0, -0.01]}},
        "method": {"tolerance": 1e-4, **method},
    }


def values(profile, t):
    """The cubics of a profile at places t."""
    (at, height), slopes = numpy.transpose(profile["points"]), numpy.array(profile["slopes"])
    k = numpy.clip(numpy.searchsorted(at, t, side="right"), 1, len(at) - 1) - 1
    h = at[k + 1] - at[k]
    u, m, n, p, q = (t - at[k]) / h, slopes[k, 1] * h, slopes[k + 1, 0] * h, height[k], height[k + 1]
    return p + u * (m + u * (3 * (q - p) - 2 * m - n + u * (m + n - 2 * (q - p))))


def test_smooth_functions_are_met_everywhere():
    seed = 7
    draw = random.Random(seed)
    for case in range(40):
        terms = [(draw.uniform(-1, 1), draw.uniform(0, 60), draw.uniform(0, 6)) for _ in range(3)]
        shift, scale = draw.uniform(-5, 5), 10 ** draw.uniform(-6, 3)
        tolerance = 10 ** draw.uniform(-12, -3)

        def function(x):
            return scale * (2 + sum(a * math.sin(w * x + c) for a, w, c in terms) + math.exp(-((x - shift) ** 2)))

        start, stop = shift - draw.uniform(0.1, 1), shift + draw.uniform(0.1, 1)
        profile = steklov.profile(function, start, stop, tolerance=tolerance)
        largest = max(abs(height) for _, height in profile["points"])
        places = [draw.uniform(start, stop) for _ in range(2000)]
        error = numpy.abs(values(profile, numpy.array(places)) - [function(t) for t in places]).max() / largest
        assert error <= 2 * tolerance + 1e-13, (seed, case, error, tolerance, len(profile["points"]))
        assert all(before == behind for before, behind in profile["slopes"]), (seed, case)
        assert profile["points"][0][0] == start and profile["points"][-1][0] == stop


def test_a_gap_by_a_function_is_that_by_an_expression():
    for function, text, kinks in [
        (lambda x: 0.02 * (1 - math.cos(6 * x)), "0.02*(1 - cos(6*x))", []),
        (lambda x: 0.02 * abs(x - 0.3) + 0.01 * x**2, "0.02*abs(x - 0.3) + 0.01*x^2", [0.3]),
    ]:
        by_function = steklov.solve(block(steklov.profile(function, 0, 1, kinks=kinks))).quantities
        by_text = steklov.solve(block(steklov.profile(function, 0, 1, kinks=kinks), text)).quantities
        for name in ["energy", "contact.length", "contact.force.y", "dofs"]:
            assert by_function[name] == pytest.approx(by_text[name], rel=1e-8), (text, name)
    summary = steklov.solve(block(steklov.profile(lambda x: 0.05 * abs(x - 0.3), 0, 1, kinks=[0.3]))).summary
    assert summary["contact"]["max_pressure_unbounded"] is True


def test_loads_and_friction_take_profiles():
    scene = block(steklov.profile(lambda s: 1 + s**2, 0, 1))
    scene["sides"] = {
        "floor": {"contact": {"gap": "0", "friction": {"coulomb": "0.1*f(s)"}}},
        "top": {"pressure": "f(x)"},
        "left": {"displacement": [0, "free"]},
    }
    result = steklov.solve(scene)
    assert result.quantities["contact.force.y"] == pytest.approx(4 / 3, rel=1e-10)
    same = steklov.solve({**scene, "profiles": {}, "sides": {**scene["sides"],
        "floor": {"contact": {"gap": "0", "friction": {"coulomb": "0.1*(1 + s^2)"}}}, "top": {"pressure": "1 + x^2"}}})
    assert result.quantities["energy"] == pytest.approx(same.quantities["energy"], rel=1e-10)


def test_constants_lines_and_arrays():
    assert steklov.profile(lambda x: 0, -1, 1)["points"][0] == [-1.0, 0.0]
    line = steklov.profile(lambda x: 3 * x - 1, 0, 2)
    assert len(line["points"]) == 2 and numpy.allclose(line["slopes"], 3)
    assert steklov.profile(numpy.cosh, 0, 1)["points"][-1][1] == float(numpy.cosh(1.0))


def test_what_is_no_smooth_function_is_refused():
    for function, keywords, told in [
        (lambda x: math.nan if 0.4 < x < 0.6 else x, {}, "the function of a profile is nan at 0."),
        (lambda x: 1 / x if x else math.inf, {}, "is inf at 0.0"),
        (lambda x: abs(x - 1 / 3), {}, "has a kink near 0.33333.*kinks="),
        (lambda x: abs(x - 1 / 3), {"tolerance": 1e-8}, "has a kink near 0.33333"),
        (lambda x: abs(x - 1 / 3), {"kinks": [0.333333]}, "has a kink near 0.33333"),
        (lambda x: float(x > 0.7), {}, "jumps or has a kink near 0.[67]"),
        (lambda x: abs(x - 0.4999) < 1e-3, {}, "jumps or has a kink near 0.498|neighbours"),
        (lambda x: math.sqrt(x), {}, "kink near"),
        (lambda x: x, {"stop": 0}, "start is below stop"),
        (lambda x: x, {"start": math.nan}, "start is below stop"),
        (lambda x: x, {"kinks": [0, 0.5]}, "not all between"),
        (lambda x: x, {"tolerance": 1e-20}, "from 1e-14 to 0.1"),
        (lambda x: math.sin(1e4 * x), {}, "more than 100000 knots"),
    ]:
        with pytest.raises(ValueError, match=told):
            steklov.profile(function, **{"start": 0, "stop": 1, **keywords})
    with pytest.raises(ZeroDivisionError):
        steklov.profile(lambda x: 1 / x, 0, 1)
    with pytest.raises(TypeError, match="sides.floor.contact.gap is a function.*steklov.profile"):
        steklov.solve(block(steklov.profile(math.sin, 0, 1), lambda x: x))
    # a side that is longer than the profile
    with pytest.raises(steklov.SceneError) as error:
        steklov.solve(block(steklov.profile(math.cos, 0, 0.9)))
    assert "the gap of side \"floor\" is NaN at the point (" in error.value.message
    assert "the profile f reaches from 0 to 0.9" in error.value.help
