"""GetFEM: Nitsche's method for contact and Tresca friction in its weak form language, Newton, adaptive triangles.

usage: peer_getfem.py PROBLEM SETTING (loop.py), with the Python that has Debian's python3-getfem
"""

import getfem as gf
import numpy as np

import loop

NITSCHE = 1e-2
BOTTOM, WALLS, TOP, INNER = 1, 2, 3, 4
DEGREES = (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 13, 17, 19)
BUBBLE = "((X(2)+0.5)*(0.5-X(2)))"
WALL_LOAD = f"[-400*sign(X(1))*{BUBBLE}*exp(-10*sqr(X(2)+0.3)); 10*{BUBBLE}]"
TOP_LOAD = "[0; -500*sqr(0.5-X(1))*sqr(0.5+X(1))]"


def rule(mesh, degree):
    """Integration on triangles that is exact for a degree."""
    return gf.MeshIm(mesh, gf.Integ(f"IM_TRIANGLE({min(d for d in DEGREES if d >= degree)})"))


class Body:
    """Mesh, finite elements and the displacement, which is carried over to each refined mesh."""

    def __init__(self, problem, setting):
        self.problem = problem
        self.order = setting["order"]
        self.loaded = {} if problem.held else {WALLS: WALL_LOAD, TOP: TOP_LOAD}
        self.mesh = gf.Mesh("triangles grid", *problem.grid(setting["cells"], setting["told"]))
        self.known = None

    def set_up(self):
        """Regions, elements and the start of Newton's method, from the solution on the mesh before."""
        mesh = self.mesh
        faces = mesh.outer_faces()
        normal = mesh.normal_of_faces(faces)
        mesh.set_region(BOTTOM, faces[:, normal[1] < -0.5])
        mesh.set_region(TOP, faces[:, normal[1] > 0.5])
        mesh.set_region(WALLS, faces[:, abs(normal[0]) > 0.5])
        mesh.set_region(INNER, mesh.inner_faces())
        self.elements = gf.MeshFem(mesh, 2)
        self.elements.set_fem(gf.Fem(f"FEM_PK(2,{self.order})"))
        self.u = (
            gf.compute_interpolate_on(*self.known, self.elements) if self.known else np.zeros(self.elements.nbdof())
        )

    def constants(self):
        lam, mu = self.problem.lame
        size = NITSCHE * 2 / (self.problem.young * self.order**2)
        return dict(lam=lam, mu=mu, F=self.problem.friction, size=size)

    def stress(self, gradient):
        return f"(lam*Trace({gradient})*Id(2)+2*mu*Sym({gradient}))"

    def contact_form(self):
        """-g sigma(u).sigma(v) + g min(Pn, 0) Pn'(v) + g clip(Pt, F) Pt'(v) on the lower side.

        Pn = sigma_nn + (u_y + gap) / g, Pt = sigma_t - u_t / g, g = 2 NITSCHE h / (E p^2).
        """
        g = "(size*element_size)"
        gap = "(abs(X(1))/10-0.05)" if self.problem.held else "0"
        u, v = (f"({self.stress(grad)}*[0;1])" for grad in ("Grad_u", "Grad_Test_u"))
        normal = f"({u}(2)+(u(2)+{gap})/{g})"
        shear = f"(-{u}(1)-u(1)/{g})"
        stresses = f"-{g}*({u}.{v})"
        contact = f"{g}*min({normal},0)*({v}(2)+Test_u(2)/{g})"
        friction = f"{g}*max(min({shear},F),-F)*(-{v}(1)-Test_u(1)/{g})"
        return f"{stresses}+{contact}+{friction}"

    def solve(self):
        self.set_up()
        mesh, order = self.mesh, self.order
        inside, edges, loads = rule(mesh, 2 * order - 2), rule(mesh, 2 * order + 2), rule(mesh, 17)
        model = gf.Model("real")
        model.add_fem_variable("u", self.elements)
        for name, value in self.constants().items():
            model.add_initialized_data(name, [value])
        model.add_isotropic_linearized_elasticity_brick(inside, "u", "lam", "mu")
        model.add_nonlinear_term(edges, self.contact_form(), BOTTOM)
        for region, load in self.loaded.items():
            model.add_source_term(loads, f"({load}).Test_u", region)
        if self.problem.held:
            model.add_Dirichlet_condition_with_simplification("u", TOP)
        else:  # nothing but friction holds the block along x: its middle line, which does not move, is held at the top
            model.add_initialized_data("point", [0.0, 0.5])
            model.add_initialized_data("direction", [1.0, 0.0])
            model.add_pointwise_constraints_with_multipliers("u", "point", "direction")
        model.set_variable("u", self.u)
        iterations, converged = model.solve("max_res", 1e-7, "max_iter", 40, "lsolver", "mumps")[:2]
        self.u = model.variable("u")
        return dict(dofs=int(model.nbdof()), iterations=int(iterations), converged=bool(converged))

    def assemble(self, degree, expression, region):
        """The integral of an expression in u over a region."""
        data = [item for name, value in self.constants().items() for item in (name, 0, [value])]
        return gf.asm_generic(rule(self.mesh, degree), 0, expression, region, "u", 0, self.elements, self.u, *data)

    def energy(self):
        strain = self.assemble(2 * self.order, f"0.5*({self.stress('Grad_u')}:Grad_u)", -1)
        work = sum(self.assemble(19, f"({load}).u", region) for region, load in self.loaded.items())
        return float(strain - work + self.assemble(19, "F*abs(u(1))", BOTTOM))

    def indicators(self):
        """h times the jumps of the traction between elements and its error on loaded sides, squared."""
        constant = gf.MeshFem(self.mesh, 1)
        constant.set_fem(gf.Fem("FEM_PK(2,0)"))
        stress = self.stress("Grad_u")
        jump = f"(({stress}-{self.stress('Interpolate(Grad_u,neighbor_element)')})*Normal)"
        both = "(Test_psi+Interpolate(Test_psi,neighbor_element))"
        terms = {INNER: f"0.5*element_size*Norm_sqr({jump})*{both}"}
        for region in () if self.problem.held else (WALLS, TOP):
            load = self.loaded[region]
            terms[region] = f"element_size*Norm_sqr({stress}*Normal-{load})*Test_psi"
        data = [item for name, value in self.constants().items() for item in (name, 0, [value])]
        squares = 0
        for region, term in terms.items():
            psi = ("psi", 1, constant, np.zeros(constant.nbdof()))
            squares = squares + gf.asm_generic(
                rule(self.mesh, 2 * self.order), 1, term, region, *psi, "u", 0, self.elements, self.u, *data
            )
        return squares[constant.basic_dof_from_cvid()[0]]

    def touching(self, points):
        mesh = self.mesh
        vertices = [int(i) for i, p in zip(mesh.pid(), mesh.pts().T) if tuple(p) in points]
        return np.flatnonzero(np.isin(mesh.cvid(), mesh.cvid_from_pid(vertices, True)))

    def refine(self, elements):
        if hasattr(self, "u"):  # the elements live on the mesh, which changes
            before = gf.MeshFem(gf.Mesh("clone", self.mesh), 2)
            before.set_fem(gf.Fem(f"FEM_PK(2,{self.order})"))
            self.known = before, self.u
        self.mesh.refine(self.mesh.cvid()[elements])


if __name__ == "__main__":
    gf.util_trace_level(0)
    loop.main(Body)
