"""The settings in which each code is run; the chart uses the best of them for each error.

A quick run of the peers takes the first setting of each family.
"""

TOLERANCES = ("1e-2", "3e-3", "1e-3", "3e-4", "1e-4", "3e-5", "1e-5", "3e-6", "1e-6")
ELEMENTS = (16, 32, 64, 128, 256)

# families: adaptive; told (adaptive from a mesh with vertices at the exact ends of the contact zone); uniform


def adaptive(order, theta, graded, told=False):
    """The adaptive loop from 4 by 4 cells; `graded` matters only where the data are singular."""
    setting = dict(order=order, cells=4, theta=theta, told=told, graded=graded)
    return ("told" if told else "adaptive", setting)


def uniform(order, *cells):
    """One mesh after the other, each in a process of its own."""
    return [("uniform", dict(order=order, cells=n, theta=0.0, told=False, graded=0)) for n in cells]


PEERS = {
    "NGSolve": [
        adaptive(4, 0.8, 8),
        adaptive(5, 0.9, 4),
        adaptive(5, 0.9, 8),
        adaptive(6, 0.9, 8),
        adaptive(6, 0.95, 0),
        adaptive(5, 0.9, 8, told=True),
        adaptive(6, 0.9, 8, told=True),
        *uniform(4, 8, 16, 32, 64),
        *uniform(2, 32, 64, 128),
    ],
    "scikit-fem": [
        adaptive(4, 0.9, 8),
        adaptive(4, 0.8, 0),
        adaptive(3, 0.9, 8),
        adaptive(4, 0.9, 8, told=True),
        *uniform(4, 8, 16, 32),
        *uniform(2, 16, 32, 64),
    ],
    "GetFEM": [
        adaptive(4, 0.8, 8),
        adaptive(6, 0.9, 4),
        adaptive(4, 0.9, 4),
        adaptive(6, 0.9, 0),
        adaptive(4, 0.9, 8, told=True),
        adaptive(6, 0.9, 4, told=True),
        *uniform(4, 8, 16, 32),
        *uniform(2, 16, 32, 64),
    ],
}

# the scene as it is, to every tolerance; and single meshes
STEKLOV = [("adaptive", {"method.tolerance": t}) for t in TOLERANCES]
STEKLOV += [("uniform", {"method.refine": '"none"', "method.degree": "4", "method.elements": str(n)}) for n in ELEMENTS]


def plan(code, problem, quick):
    """The (family, setting) pairs of a code for a problem."""
    pairs = STEKLOV if code == "steklov" else PEERS[code]
    if not problem.held and code != "steklov":  # no singular data, so grading changes nothing
        merged = [(family, dict(setting, graded=0)) for family, setting in pairs]
        pairs = [pair for i, pair in enumerate(merged) if pair not in merged[:i]]
    if not quick or code == "steklov":
        return pairs
    return [next(pair for pair in pairs if pair[0] == family) for family in ("adaptive", "told", "uniform")]
