"""Functions of Python as profiles of scenes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy
from numpy.polynomial import chebyshev

DEGREE = 24
"""Degree of the polynomials that resolve a function."""
SHORTEST = 2.0**-20
"""A part of the whole length on which a smooth function is resolved."""
SHORT = 2.0**-12
"""On parts below this one no tolerance hides a kink."""
MOST_KNOTS = 100_000

Piece = tuple[float, float, "numpy.ndarray[Any, Any]"]


def profile(function: Callable[[float], float], start: float, stop: float, *, kinks: Iterable[float] = (), tolerance: float = 1e-11) -> dict[str, Any]:
    """A function of one number as a profile of a scene, sampled from `start` to `stop`.

    >>> import math, steklov
    >>> scene = {
    ...     "body": {"corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "sides": ["floor", "right", "top", "left"]},
    ...     "material": {"young": 200, "poisson": 0.3},
    ...     "profiles": {"waves": steklov.profile(lambda x: 0.01 * math.cos(6 * x), 0, 1)},
    ...     "sides": {"floor": {"contact": {"gap": "waves(x)"}}, "top": {"displacement": [0, -0.02]}},
    ... }
    >>> steklov.solve(scene).quantities["contact.length"] > 0.1
    True

    The profile is made of cubics with continuous slopes, as many as keep it within `tolerance` of the largest value. `kinks` are the
    places where the slope of the function jumps. Raises ValueError where the function is no finite number, jumps, or has a kink that is
    not among these.
    """
    start, stop, kinks = float(start), float(stop), sorted(float(kink) for kink in kinks)
    if not (math.isfinite(start) and math.isfinite(stop) and start < stop):
        raise ValueError(f"a profile from {start} to {stop}: start is below stop, both are finite")
    if not all(start < kink < stop for kink in kinks):
        raise ValueError(f"the kinks {kinks} are not all between {start} and {stop}")
    if not 1e-14 <= tolerance <= 0.1:
        raise ValueError(f"the tolerance is {tolerance}: it is a part of the largest value, from 1e-14 to 0.1")
    value = checked(function)
    ends = [start, *kinks, stop]
    scale = max(abs(value(t)) for t in numpy.linspace(start, stop, 65))
    error = tolerance * scale or tolerance
    pieces = [resolved(value, (a, b), error, stop - start) for a, b in zip(ends, ends[1:])]
    at, slopes = knots([piece for part in pieces for piece in part], kinks, error)
    heights = [value(t) for t in at]
    check(value, at, heights, slopes, error)
    return {"points": [list(knot) for knot in zip(at, heights)], "slopes": slopes}


def checked(function: Callable[[float], float]) -> Callable[[float], float]:
    """The function, which raises ValueError where it is no finite number."""

    def value(t: float) -> float:
        found = float(function(float(t)))
        if not math.isfinite(found):
            raise ValueError(f"the function of a profile is {found} at {float(t)!r}: it must be finite from start to stop")
        return found

    return value


def resolved(value: Callable[[float], float], ends: tuple[float, float], error: float, whole: float) -> list[Piece]:
    """Parts of an interval on which Chebyshev polynomials are within `error` of the function, in order."""
    nodes = numpy.cos(numpy.pi * numpy.arange(DEGREE, -1, -1) / DEGREE)
    done: list[Piece] = []
    waiting = [ends]
    while waiting:
        a, b = waiting.pop()
        values = [value(min(max((a + b) / 2 + (b - a) / 2 * node, a), b)) for node in nodes]
        polynomial = chebyshev.chebfit(nodes, values, DEGREE)
        rounding, variation = 1e-14 * max(map(abs, values)), max(values) - min(values)
        near = error / 4 if b - a > SHORT * whole else min(error / 4, 1e-5 * variation)
        if numpy.abs(polynomial[-3:]).max() <= max(near, rounding):
            done.append((a, b, chebyshev.chebtrim(polynomial, max(error / 64, rounding))))
        elif b - a <= SHORTEST * whole:
            raise ValueError(f"the function of a profile jumps or has a kink near {(a + b) / 2:.7g}: tell kinks by kinks=[...]; for a jump take two profiles")
        else:
            middle = (a + b) / 2
            waiting += [(middle, b), (a, middle)]
        if len(done) > MOST_KNOTS // 8:
            raise ValueError(f"a profile of the function would have more than {MOST_KNOTS} knots: take a larger tolerance, or a shorter part")
    return done


def knots(pieces: list[Piece], kinks: list[float], error: float) -> tuple[list[float], list[list[float]]]:
    """Positions at which cubics may begin, and the slopes before and behind them.

    A cubic by values and slopes at a distance h is off by h^4 max|f''''| / 384.
    """
    at: list[float] = []
    slopes: list[list[float]] = []
    for a, b, polynomial in pieces:
        half = (b - a) / 2
        fourth = numpy.abs(chebyshev.chebval(numpy.linspace(-1, 1, 65), chebyshev.chebder(polynomial, 4))).max()
        count = max(1, math.ceil(2 * (fourth / (384 * error)) ** 0.25))
        if len(at) + count > MOST_KNOTS:
            raise ValueError(f"a profile of the function would have more than {MOST_KNOTS} knots: take a larger tolerance, or a shorter part")
        nodes = numpy.linspace(-1, 1, count + 1)
        slope = [float(m) for m in chebyshev.chebval(nodes, chebyshev.chebder(polynomial)) / half]
        if at:
            # where two polynomials meet smoothly their slopes differ by rounding
            slopes[-1] = [slopes[-1][0], slope[0]] if a in kinks else [(slopes[-1][0] + slope[0]) / 2] * 2
        else:
            at, slopes = [a], [[slope[0]] * 2]
        at += [float((a + b) / 2 + half * node) for node in nodes[1:-1]] + [b]
        slopes += [[m, m] for m in slope[1:]]
    return at, slopes


def check(value: Callable[[float], float], at: list[float], heights: list[float], slopes: list[list[float]], error: float) -> None:
    """Compares function and cubics between the knots, where neither was sampled."""
    for (a, p, m), (b, q, n) in zip(zip(at, heights, (s[1] for s in slopes)), zip(at[1:], heights[1:], (s[0] for s in slopes[1:]))):
        middle = (p + q) / 2 + (b - a) * (m - n) / 8
        found = value((a + b) / 2)
        if abs(found - middle) > 16 * error + 1e-13 * (abs(p) + abs(q)):
            raise ValueError(f"the function of a profile is {found!r} at {(a + b) / 2!r}, where its neighbours lead to {middle!r}: tell its kinks, or sample it in parts")
