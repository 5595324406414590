"""Cook's membrane (cook.toml) by bilinear and biquadratic quadrilaterals of scikit-fem, as Poisson's ratio tends to 1/2.

usage: q1.py FILE
writes a JSON list of {"name", "poisson", "energy"} for `steklov study cook.toml --what stability --beside FILE`
"""

import json
import sys

import numpy as np
import skfem
from skfem.helpers import ddot, eye, sym_grad, trace

YOUNG, SHEAR = 1.0, 1 / 16
# those of the study
POISSON = (0.3, 0.4, 0.45, 0.49, 0.499, 0.4999, 0.49999, 0.4999999)
# elements a side, and the element: bilinear ones lock, biquadratic ones lose an order
MESHES = ((8, "Q1"), (32, "Q1"), (128, "Q1"), (32, "Q2"))
ELEMENTS = {"Q1": skfem.ElementQuad1, "Q2": skfem.ElementQuad2}


def membrane(cells):
    """Straight-sided quadrilaterals: the unit square moved onto the panel."""
    mesh = skfem.MeshQuad.init_tensor(*2 * [np.linspace(0, 1, cells + 1)])
    s, t = mesh.p
    return skfem.MeshQuad(np.array([48 * s, 44 * s + t * (44 - 28 * s)]), mesh.t)


def energy(cells, name, poisson):
    """J = a(u, u)/2 - L(u) in plane strain."""
    mesh = membrane(cells)
    element = skfem.ElementVector(ELEMENTS[name]())
    basis = skfem.Basis(mesh, element)
    lam, mu = YOUNG * poisson / ((1 + poisson) * (1 - 2 * poisson)), YOUNG / (2 * (1 + poisson))

    def stress(u):
        return lam * eye(trace(sym_grad(u)), 2) + 2 * mu * sym_grad(u)

    stiffness = skfem.BilinearForm(lambda u, v, w: ddot(stress(u), sym_grad(v))).assemble(basis)
    right = skfem.FacetBasis(mesh, element, facets=mesh.facets_satisfying(lambda x: abs(x[0] - 48) < 1e-9, True))
    load = skfem.LinearForm(lambda v, w: SHEAR * v[1]).assemble(right)
    held = basis.get_dofs(lambda x: abs(x[0]) < 1e-9).all()
    u = skfem.solve(*skfem.condense(stiffness, load, D=held))
    return float(0.5 * u @ (stiffness @ u) - load @ u)


def main(path):
    results = [
        dict(name=f"scikit-fem {name}, {cells}²", poisson=poisson, energy=energy(cells, name, poisson))
        for cells, name in MESHES
        for poisson in POISSON
    ]
    with open(path, "w", encoding="utf-8") as file:
        json.dump(results, file, indent=1)


if __name__ == "__main__":
    main(sys.argv[1])
