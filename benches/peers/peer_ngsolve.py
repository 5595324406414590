"""NGSolve: Nitsche's method for contact and Tresca friction as a symbolic form, Newton, adaptive triangles.

usage: peer_ngsolve.py PROBLEM SETTING (loop.py)
"""

import ngsolve as ng
from ngsolve import Grad, IfPos, InnerProduct, ds, dx, x, y
from ngsolve.meshes import MakeStructured2DMesh

import loop

NITSCHE = 1e-2


class Body:
    """Mesh, space, forms and the displacement, which is carried over to each refined mesh."""

    def __init__(self, problem, setting):
        self.problem = problem
        self.order = setting["order"]
        xs, ys = problem.grid(setting["cells"], setting["told"])
        nx, ny = len(xs) - 1, len(ys) - 1
        self.mesh = MakeStructured2DMesh(False, nx, ny, mapping=lambda a, b: (xs[round(a * nx)], ys[round(b * ny)]))
        held = "top" if problem.held else ""
        self.space = ng.VectorH1(self.mesh, order=self.order, dirichlet=held, autoupdate=True, hoprolongation=True)
        self.u = ng.GridFunction(self.space, autoupdate=True, nested=True)
        smooth = ng.VectorH1(self.mesh, order=self.order, autoupdate=True)
        self.smooth = [ng.GridFunction(smooth, autoupdate=True) for _ in range(2)]
        self.form = self.weak_form()
        self.load = self.loads()
        # nothing but friction holds the block along x: its middle line, which does not move, is held at the top
        pinned = [] if problem.held else [v.nr for v in self.mesh.vertices if v.point == (0.0, 0.5)]
        self.pinned = [ng.NodeId(ng.VERTEX, nr) for nr in pinned]

    def stress(self, u):
        lam, mu = self.problem.lame
        return lam * ng.Trace(Grad(u)) * ng.Id(2) + mu * (Grad(u) + Grad(u).trans)

    def weak_form(self):
        """a(u, v) + (-g sigma(u).sigma(v) + g min(Pn, 0) Pn'(v) + g clip(Pt, F) Pt'(v)) on the lower side.

        Pn = sigma_nn + (u_y + gap) / g, Pt = sigma_t - u_t / g, g = 2 NITSCHE h / (E p^2).
        Interior unknowns are condensed.
        """
        problem, bound = self.problem, self.problem.friction
        u, v = self.space.TnT()
        g = 2 * NITSCHE * ng.specialcf.mesh_size / (problem.young * self.order**2)
        gap = IfPos(x, x, -x) / 10 - 0.05 if problem.held else ng.CF(0)
        su, sv = self.stress(u), self.stress(v)
        normal = su[1, 1] + (u[1] + gap) / g
        shear = -su[0, 1] - u[0] / g
        clipped = IfPos(shear - bound, bound, IfPos(-bound - shear, -bound, shear))
        contact = -g * (su[1, 1] * sv[1, 1] + su[0, 1] * sv[0, 1])
        contact += g * IfPos(normal, 0, normal) * (sv[1, 1] + v[1] / g) - g * clipped * (sv[0, 1] + v[0] / g)
        form = ng.BilinearForm(self.space, symmetric=True, condense=True)
        form += InnerProduct(su, Grad(v)) * dx
        # skeleton: gradients of the whole element, not only along the side
        form += contact.Compile() * ds(skeleton=True, definedon=self.mesh.Boundaries("bottom"), bonus_intorder=4)
        return form

    def loads(self):
        load, v = ng.LinearForm(self.space), self.space.TestFunction()
        if not self.problem.held:
            bubble = (y + 0.5) * (0.5 - y)
            for sign, side in ((-1, "right"), (1, "left")):
                push = sign * 400 * bubble * ng.exp(-10 * (y + 0.3) ** 2)
                load += (push * v[0] + 10 * bubble * v[1]) * ds(side, bonus_intorder=8)
            load += -500 * (0.5 - x) ** 2 * (0.5 + x) ** 2 * v[1] * ds("top", bonus_intorder=4)
        return load

    def solve(self):
        with ng.TaskManager():
            self.load.Assemble()
            free = ng.BitArray(self.space.FreeDofs(True))
            for vertex in self.pinned:
                free.Clear(self.space.components[0].GetDofNrs(vertex)[0])
            u, form, inverse = self.u.vec, self.form, None
            residual, step = u.CreateVector(), u.CreateVector()
            for iteration in range(1, 41):
                form.Apply(u, residual)
                residual.data -= self.load.vec
                form.AssembleLinearization(u)
                residual.data += form.harmonic_extension_trans * residual
                if inverse is None:
                    inverse = form.mat.Inverse(free, "sparsecholesky")
                else:
                    inverse.Update()
                step.data = inverse * residual
                step.data += form.harmonic_extension * step
                step.data += form.inner_solve * residual
                u.data -= step
                converged = ng.Norm(step) < 1e-7 * ng.Norm(u)
                if converged:
                    break
        return dict(dofs=self.space.ndof, iterations=iteration, converged=converged)

    def energy(self):
        """The integration orders are given because the default is 5."""
        u, mesh = self.u, self.mesh
        strain = ng.Integrate(0.5 * InnerProduct(self.stress(u), Grad(u)), mesh, order=2 * self.order)
        sliding = ng.Integrate(IfPos(u[0], u[0], -u[0]), mesh, definedon=mesh.Boundaries("bottom"), order=40)
        return strain - self.load.vec.InnerProduct(u.vec) + self.problem.friction * sliding

    def indicators(self):
        """Distance of the stress from its continuous average, element by element (Zienkiewicz and Zhu)."""
        stress = self.stress(self.u)
        with ng.TaskManager():
            jump = 0
            for row, smooth in enumerate(self.smooth):
                smooth.Set(stress[row, :])
                jump += InnerProduct(smooth - stress[row, :], smooth - stress[row, :])
            squares = ng.Integrate(jump, self.mesh, order=2 * self.order, element_wise=True)
        return squares.NumPy()

    def touching(self, points):
        return [e.nr for e in self.mesh.Elements() if any(self.mesh[v].point in points for v in e.vertices)]

    def refine(self, elements):
        chosen = set(elements)
        for element in self.mesh.Elements():
            self.mesh.SetRefinementFlag(element, element.nr in chosen)
        with ng.TaskManager():
            self.mesh.Refine()


if __name__ == "__main__":
    ng.SetNumThreads(loop.THREADS)
    loop.main(Body)
