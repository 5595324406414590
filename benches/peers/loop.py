"""What a program that runs one peer does: warm-up, then solve and refine in turn, one JSON line a mesh.

usage of each peer: PROGRAM PROBLEM SETTING, the setting as JSON:
  order    polynomial degree
  cells    cells along a side of the first mesh
  theta    0: that mesh only. Otherwise the adaptive loop: refines the elements with this share of the estimate
  told     start from a mesh with vertices at the exact ends of the contact zone
  graded   times that the elements at singular points of the data (Problem.kinks) are refined before the first solution
  seconds  no new mesh is begun after so much time (of the timed parts)
"""

import json
import os
import sys
import time

import numpy as np

from problems import PROBLEMS

THREADS = int(os.environ.get("OMP_NUM_THREADS", "2"))


def marked(indicators, theta):
    """The smallest set of elements whose indicators (squares) sum to `theta` of the total."""
    order = np.argsort(-indicators)
    count = np.searchsorted(np.cumsum(indicators[order]), theta * indicators.sum()) + 1
    return order[:count]


def walk(body_of, problem, setting):
    """Yields (seconds, body, answer) mesh by mesh; the seconds add up and leave out what the caller does."""
    start = time.perf_counter()
    body = body_of(problem, setting)
    for _ in range(setting["graded"] if problem.kinks else 0):
        body.refine(body.touching(problem.kinks))
    answer = body.solve()
    seconds = time.perf_counter() - start
    yield seconds, body, answer
    while setting["theta"] > 0 and answer["converged"] and seconds < setting["seconds"]:
        start = time.perf_counter()
        body.refine(marked(body.indicators(), setting["theta"]))
        answer = body.solve()
        seconds += time.perf_counter() - start
        yield seconds, body, answer


def main(body_of):
    """Runs the command line.

    `body_of(problem, setting)` has solve(), energy(), indicators(), touching(points) and refine(elements).
    """
    problem, setting = PROBLEMS[sys.argv[1]], json.loads(sys.argv[2])
    small = dict(setting, cells=min(setting["cells"], 4), seconds=0.05)
    for _, body, _ in walk(body_of, problem, small):
        body.energy()
    for seconds, body, answer in walk(body_of, problem, setting):
        energy = body.energy() if answer["converged"] else None
        print(json.dumps(dict(answer, seconds=seconds, energy=energy)), flush=True)
