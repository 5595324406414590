"""scikit-fem: Nitsche's method for contact and Tresca friction, semi-smooth Newton, adaptive triangles.

usage: peer_skfem.py PROBLEM SETTING (loop.py)
"""

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl
import skfem
from skfem.helpers import ddot, dot, eye, sym_grad, trace

import loop

NITSCHE = 1e-2
ELEMENTS = {2: skfem.ElementTriP2, 3: skfem.ElementTriP3, 4: skfem.ElementTriP4}


class Body:
    """Mesh, basis and the state of the lower side, which is carried over to each refined mesh."""

    def __init__(self, problem, setting):
        self.problem = problem
        self.order = setting["order"]
        self.element = skfem.ElementVector(ELEMENTS[self.order]())
        # Newton's method starts from Pn and Pt on the lower side: closed and sticking, then as on the last mesh
        self.known = [([0.0], [-1.0]), ([0.0], [0.0])]
        self.mesh = skfem.MeshTri.init_tensor(*problem.grid(setting["cells"], setting["told"]))

    def set_up(self):
        """Bases, stiffness, loads and the matrices that give stress and displacement on the lower side."""
        mesh = self.mesh
        sides = dict(bottom=lambda x: x[1] == -0.5, walls=lambda x: abs(x[0]) == 0.5, top=lambda x: x[1] == 0.5)
        sides = {name: mesh.facets_satisfying(test, boundaries_only=True) for name, test in sides.items()}
        self.basis = skfem.Basis(mesh, self.element, intorder=2 * self.order - 2)
        on = {s: skfem.FacetBasis(mesh, self.element, facets=f, intorder=2 * self.order + 2) for s, f in sides.items()}
        self.on = on
        stress = self.stress
        self.stiffness = (
            skfem.BilinearForm(lambda u, v, w: ddot(stress(u), sym_grad(v)), nthreads=loop.THREADS)
            .assemble(self.basis)
            .tocsr()
        )
        walls = skfem.LinearForm(lambda v, w: dot(np.stack(self.problem.side_load(*w.x)), v))
        top = skfem.LinearForm(lambda v, w: self.problem.top_load(w.x[0]) * v[1])
        self.load = walls.assemble(on["walls"]) + top.assemble(on["top"])
        if self.problem.held:
            fixed = self.basis.get_dofs(sides["top"]).all()
        else:  # nothing but friction holds the block along x: its middle line, which does not move, is held at the top
            middle = np.flatnonzero((mesh.p[0] == 0) & (mesh.p[1] == 0.5))
            fixed = self.basis.nodal_dofs[0, middle]
        self.free = np.setdiff1d(np.arange(self.basis.N), fixed)
        self.normal_stress = at_points(on["bottom"], lambda u: stress(u)[1, 1])
        self.shear_stress = at_points(on["bottom"], lambda u: -stress(u)[0, 1])
        self.lift = at_points(on["bottom"], lambda u: u[1])
        self.slide = at_points(on["bottom"], lambda u: u[0])

    def stress(self, u):
        lam, mu = self.problem.lame
        strain = sym_grad(u)
        return lam * eye(trace(strain), 2) + 2 * mu * strain

    def solve(self):
        """a(u, v) + (-g sigma(u).sigma(v) + g min(Pn, 0) Pn'(v) + g clip(Pt, F) Pt'(v)) on the lower side = L(v).

        Pn = sigma_nn + (u_y + gap) / g, Pt = sigma_t - u_t / g, g = 2 NITSCHE h / (E p^2).
        """
        self.set_up()
        problem, bound, weights = self.problem, self.problem.friction, self.on["bottom"].dx.ravel()
        at = self.on["bottom"].default_parameters()
        g = NITSCHE * at["h"].ravel() * 2 / (problem.young * self.order**2)
        points = at["x"][0].ravel()
        gap = problem.gap(points)
        over_g = sp.diags(1 / g)
        normal, shear = self.normal_stress + over_g @ self.lift, self.shear_stress - over_g @ self.slide
        area = weights * g
        tractions = (self.normal_stress, self.shear_stress)
        linear = self.stiffness - sum(s.T @ sp.diags(area) @ s for s in tractions)
        pn, pt = (np.interp(points, *known) for known in self.known)
        u, free = np.zeros(self.basis.N), self.free
        for iteration in range(1, 41):
            closed, stick = pn < 0, abs(pt) < bound
            sliding = np.where(stick, 0, bound * np.sign(pt))
            tangent = linear + normal.T @ sp.diags(area * closed) @ normal + shear.T @ sp.diags(area * stick) @ shear
            right = self.load - normal.T @ (area * closed * gap / g) - shear.T @ (area * sliding)
            options = dict(permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=dict(SymmetricMode=True))
            before, u = u, np.zeros_like(u)
            u[free] = spl.splu(tangent[free][:, free].tocsc(), **options).solve(right[free])
            pn, pt = normal @ u + gap / g, shear @ u
            converged = bool(np.linalg.norm(u - before) < 1e-7 * np.linalg.norm(u))
            if converged or not np.isfinite(u).all():
                break
        order = np.argsort(points)
        self.u, self.known = u, [(points[order], p[order]) for p in (pn, pt)]
        return dict(dofs=len(free), iterations=iteration, converged=converged)

    def energy(self):
        u = self.u
        basis = skfem.FacetBasis(self.mesh, self.element, facets=self.on["bottom"].find, intorder=40)
        sliding = np.sum(abs(at_points(basis, lambda u: u[0]) @ u) * basis.dx.ravel())
        return float(0.5 * u @ (self.stiffness @ u) - self.load @ u + self.problem.friction * sliding)

    def indicators(self):
        """h times the jumps of the traction between elements and its error on loaded sides, squared."""
        u, mesh, element = self.u, self.mesh, self.element
        squares = np.zeros(mesh.nelements)

        def add(facets, sides, difference):
            value = np.sum((difference**2).sum(0) * facets.dx, axis=1) * facets.dx.sum(1)
            for side in sides:
                np.add.at(squares, mesh.f2t[side, facets.find], value / len(sides))

        first, second = (skfem.InteriorFacetBasis(mesh, element, side=s, intorder=2 * self.order) for s in (0, 1))
        jump = self.stress(first.interpolate(u)) - self.stress(second.interpolate(u))
        add(first, (0, 1), np.einsum("ijfq,jfq->ifq", jump, first.normals))
        for side, load in (
            ("walls", lambda x: self.problem.side_load(*x)),
            ("top", lambda x: (0 * x[0], self.problem.top_load(x[0]))),
        ):
            if side == "top" and self.problem.held:
                continue
            basis = self.on[side]
            traction = np.einsum("ijfq,jfq->ifq", self.stress(basis.interpolate(u)), basis.normals)
            add(basis, (0,), traction - np.stack(load(basis.default_parameters()["x"])))
        return squares

    def touching(self, points):
        vertices = [i for i, p in enumerate(self.mesh.p.T) if tuple(p) in points]
        return np.flatnonzero(np.isin(self.mesh.t, vertices).any(axis=0))

    def refine(self, elements):
        self.mesh = self.mesh.refined(elements)


def at_points(basis, quantity):
    """The sparse matrix that gives a quantity, linear in u, at the quadrature points of a basis."""
    facets, points = basis.dx.shape
    rows = np.arange(facets * points)
    matrix = sp.csr_matrix((len(rows), basis.N))
    values = [np.asarray(quantity(basis.basis[i][0])).ravel() for i in range(basis.Nbfun)]
    columns = [np.repeat(basis.element_dofs[i], points) for i in range(basis.Nbfun)]
    entries = (np.concatenate(values), (np.tile(rows, basis.Nbfun), np.concatenate(columns)))
    return matrix + sp.csr_matrix(entries, shape=matrix.shape)


if __name__ == "__main__":
    loop.main(Body)
