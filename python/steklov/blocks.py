"""The numerics one by one, as arrays of numpy: quadrature rules, boundary meshes, boundary operators, contact problems, random fields
and multiscale bases.

Vectors have two entries x, y; unknowns of vectors are interleaved: those of node i are 2 i and 2 i + 1. Units are the caller's own, and
everything is per unit thickness. Arrays that a block has are its own and cannot be written; copy them to change them. What is wrong with
data is a BlockError that names the place and the remedy.

>>> import numpy
>>> from steklov import blocks
>>> square = blocks.Polygon([[0, 0], [1, 0], [1, 1], [0, 1]], ["bottom", "right", "top", "left"])
>>> mesh = blocks.Mesh.uniform(square, 8, 2)
>>> operators = blocks.Operators(mesh, young=1.0, poisson=0.0)
>>> u = (mesh.nodes * [1, 0]).ravel()  # stretched along x: twice the energy is 1
>>> round(float(u @ operators.S @ u), 9)
1.0
"""

import math
from functools import cached_property
from typing import NamedTuple

import numpy

from . import _steklov
from .checks import array, count, entries, number, numbers, of_kind, own, spread, word
from .errors import BlockError, near

__all__ = ["CellBasis", "ContactAnswer", "ContactProblem", "KarhunenLoeve", "Loop", "Mesh", "Operators", "Polygon", "Rule", "Steklov"]
__all__ += ["cell_basis", "circle", "rule"]


class Rule(NamedTuple):
    """A quadrature rule: the integral of f w is nearly `weights @ f(points)`, exactly for polynomials f up to a degree."""

    points: numpy.ndarray
    weights: numpy.ndarray
    degree: int


# what each kind of rule takes beside n
_RULES = {
    "gauss": {},
    "lobatto": {},
    "jacobi": {"alpha": 0.0, "beta": 0.0},
    "graded": {"layers": 8, "ratio": 0.15, "end": "both"},
    "logarithmic": {"power": 5},
}


def rule(kind, n, **more):
    """A quadrature rule; its points rise and its weights are positive.

    "gauss": n points on [-1, 1], of degree 2 n - 1.
    "lobatto": n >= 2 points with both ends, of degree 2 n - 3.
    "jacobi": for the weight (1-x)^alpha (1+x)^beta, both above -1; degree 2 n - 1.
    "graded": n Gauss points on each of layers + 1 panels that shrink by `ratio` towards the `end` "left", "right" or "both" of [-1, 1];
    with `end="zero"` on [0, 1], where the points are the distances from 0 to full accuracy. Errors for x^a log x fall like
    ratio^((1+a) layers).
    "logarithmic": n Gauss points in t on [0, 1], x = t^power, for A(x) + B(x) log x with smooth A and B; degree 2 n // power - 1.
    """
    known = _RULES[word("kind", kind, _RULES)]
    for name in more:
        if name not in known:
            takes = ", ".join(known) or "n alone"
            raise BlockError(f"{name!r} belongs to no rule {kind!r}{near(name, known)}: that takes {takes}")
    given = {**{name: value for kinds in _RULES.values() for name, value in kinds.items()}, **more}
    points, weights, degree = _steklov.rule(
        kind,
        count("n", n, 1),
        [number(name, given[name]) for name in ("alpha", "beta")],
        (count("layers", given["layers"]), number("ratio", given["ratio"]), word("end", given["end"], ["left", "right", "both", "zero"])),
        count("power", given["power"], 1),
    )
    return Rule(points, weights, degree)


class Loop(NamedTuple):
    """A closed chain of edges: `corners` (N, 2) counter-clockwise, `sides[k]` the name of the edge from corner k to the next, and
    `turns[k]` the angle in radians by which it turns, a circular arc, positive to the left; 0 is straight, None all of them."""

    corners: object
    sides: object
    turns: object = None


def circle(centre, radius, side, arcs=4):
    """A circle as a loop of equal arcs of one side, counter-clockwise from the right."""
    centre, radius, arcs = numbers("centre", centre, (2,)), number("radius", radius), count("arcs", arcs, 2)
    if radius <= 0:
        raise BlockError(f"radius is {radius}: it must be positive")
    # the ends of the axes without rounding
    axes = {0: (1, 0), 1: (0, 1), 2: (-1, 0), 3: (0, -1)}
    angles = [2 * math.pi * k / arcs for k in range(arcs)]
    unit = [(math.cos(a), math.sin(a)) if 4 * k % arcs else axes[4 * k // arcs] for k, a in enumerate(angles)]
    return Loop(centre + radius * numpy.array(unit), [side] * arcs, [2 * math.pi / arcs] * arcs)


def _listed(name, loop):
    """A loop for the extension module."""
    try:
        corners, sides, turns = loop if len(loop) == 3 else (*loop, None)
    except (TypeError, ValueError):
        raise BlockError(f"{name} is {loop!r}: it is a blocks.Loop, or corners and sides") from None
    corners = numbers(f"{name}.corners", corners, (None, 2))
    names = entries(f"{name}.sides", sides, "a name for each edge")
    if len(names) != len(corners) or not all(isinstance(side, str) for side in names):
        raise BlockError(f"{name}.sides is {sides!r}: it lists a name for each of {len(corners)} edges")
    turns = [] if turns is None else numbers(f"{name}.turns", turns, (len(corners),)).tolist()
    return corners.tolist(), names, turns


class Polygon:
    """A body with holes: `Polygon(corners, sides)` of straight edges, corners counter-clockwise, `sides[k]` the name of the edge from
    corner k to the next; `turns` as in Loop makes arcs. A Loop may stand for its parts: `Polygon(circle([0, 0], 1, "rim"))`. Holes are
    loops, in either order. Edges of one name are one side.
    """

    def __init__(self, corners, sides=None, holes=(), *, turns=None):
        whole = isinstance(corners, Loop) and sides is None and turns is None
        outer = corners if whole else Loop(corners, [] if sides is None else sides, turns)
        self._set(_listed("outer", outer), holes)

    def _set(self, outer, holes):
        if isinstance(holes, Loop):
            raise BlockError("holes is a loop: list the holes, [loop]")
        holes = entries("holes", holes, "loops")
        self._of = _steklov.Polygon(outer, [_listed(f"holes[{k}]", hole) for k, hole in enumerate(holes)])

    @classmethod
    def outside(cls, holes):
        """The plane around holes."""
        polygon = cls.__new__(cls)
        polygon._set(None, holes)
        return polygon

    @property
    def area(self):
        """The area, without holes; infinite for the plane around holes."""
        return self._of.area()

    @property
    def diameter(self):
        """The largest distance of two points of the boundary."""
        return self._of.diameter()

    @property
    def centroid(self):
        """The centre of mass (2,); that of the holes, for the plane around them."""
        return own(numpy.array(self._of.centroid()))

    @property
    def sides(self):
        """The names of the sides as they first appear."""
        return self._of.sides()

    @property
    def edges(self):
        """The number of edges: those of the outer loop as listed, then those of the holes."""
        return self._of.edges()

    @property
    def bounded(self):
        """Whether there is an outer loop."""
        return self._of.is_bounded()

    def __repr__(self):
        return f"<blocks.Polygon: {self.edges} edges, sides {', '.join(self.sides)}>"


class Mesh:
    """An hp mesh of the boundary: elements of N polynomial degrees p, the body to their left.

    `ends` (N, 2, 2): start and end point of each element. `next` (N,): the element after it. `degree` (N,): p of the displacement, that
    of the traction is p - 1. `side` (N,): an index into `sides`. `edge` (N,): the edge of the polygon. `length` (N,). `normal` (N, 2):
    out of the body, in the middle.

    `nodes` (n, 2): the points of displacements, Gauss-Lobatto points of the elements, each element's own from its start on; its last one
    is the first of the next element. `offset` (N+1,): the number of each element's first node, which is also that of its first Legendre
    coefficient of the traction, of which it has p.
    """

    def __init__(self, of, polygon):
        self._of, self.polygon = of, polygon
        for name, part in of.arrays().items():
            setattr(self, name, own(part))
        self.sides = of.sides()

    @classmethod
    def uniform(cls, polygon, elements, degree):
        """So many elements of one degree (1 to 64), equal ones on each edge, more on longer edges; at least one on each."""
        of = of_kind("polygon", polygon, Polygon)._of
        return cls(_steklov.Mesh.uniform(of, count("elements", elements, 1), count("degree", degree, 1)), polygon)

    @classmethod
    def graded(cls, polygon, towards, layers, ratio=0.15, degree=1):
        """Elements that shrink by `ratio` towards points of the boundary, in so many layers.

        `towards` lists pairs of an edge and s in [0, 1] along it: (k, 0) is corner k. `degree` is one for all, or layers + 1 of them, the
        first of the elements at the points.
        """
        of, layers = of_kind("polygon", polygon, Polygon)._of, count("layers", layers)
        towards = numbers("towards", towards, (None, 2))
        pairs = [(count(f"towards[{k}][0]", int(edge) if edge == int(edge) else edge), s) for k, (edge, s) in enumerate(towards.tolist())]
        if layers > 1000:
            raise BlockError(f"layers is {layers}: beyond 1000 no number holds the smallest element")
        one = array("degree", degree).ndim == 0
        degrees = [count("degree", degree, 1)] * (layers + 1) if one else [count("degree", p, 1) for p in degree]
        return cls(_steklov.Mesh.graded(of, pairs, layers, number("ratio", ratio), degrees), polygon)

    def _marked(self, marked):
        """Marks from truth values or numbers of elements."""
        given = array("marked", marked)
        if given.dtype == bool and given.shape == (len(self),):
            return given.tolist()
        marks = [False] * len(self)
        if given.dtype == bool or given.ndim != 1 or given.size and given.dtype.kind not in "iu":
            raise BlockError(f"marked is an array of {given.dtype} of the shape {given.shape}: list elements, or {len(self)} truth values")
        for element in given.tolist():
            if not 0 <= element < len(self):
                raise BlockError(f"marked has the element {element}: they count from 0 below {len(self)}")
            marks[element] = True
        return marks

    def halved(self, marked):
        """The mesh with the marked elements cut in halves, and the former element of each (array): `marked` lists elements, or has a
        truth value for each."""
        mesh, parents = self._of.halved(self._marked(marked))
        return Mesh(mesh, self.polygon), parents

    def raised(self, marked):
        """The mesh with the degrees of the marked elements raised by one."""
        return Mesh(self._of.raised(self._marked(marked)), self.polygon)

    def __len__(self):
        return len(self.degree)

    def __repr__(self):
        return f"<blocks.Mesh: {len(self)} elements, {len(self.nodes)} nodes>"


class Operators:
    """The boundary operators of plane elasticity, as Galerkin matrices (2 n, 2 n) for n nodes of a mesh.

    With the displacement G(x, y) at x of a unit force at y (Kelvin's solution) and its traction T_y G on the boundary:

    V phi = ∫ G phi                  rows and columns: tractions (length^2/stress), symmetric, positive definite
    K u = ∫ (T_y G)^T u              rows: tractions, columns: displacements (length), principal value
    W u = -T_x ∫ (T_y G)^T u         rows and columns: displacements (stress), symmetric, W r = 0 for rigid motions r
    M u = u                          rows: tractions, columns: displacements (length); K r = -M r / 2 for a bounded body

    each tested by the functions of its rows. Tractions are Legendre coefficients: that of degree m on element e in direction i is unknown
    2 (mesh.offset[e] + m) + i, so that a traction t has the nodal forces M.T @ t. Displacements are values at mesh.nodes.

    `young` is a stress, `poisson` between -1 and 1/2, `plane` "strain" or "stress"; `length` is L in log(L/r), the diameter if None.
    """

    def __init__(self, mesh, young, poisson, plane="strain", length=None):
        self.mesh = of_kind("mesh", mesh, Mesh)
        plane = word("plane", plane, ["strain", "stress"])
        length = None if length is None else number("length", length)
        self._of = _steklov.Operators(mesh._of, number("young", young), number("poisson", poisson), plane, length)
        self.length = self._of.length()

    @cached_property
    def V(self):
        """The single layer matrix."""
        return own(self._of.v())

    @cached_property
    def K(self):
        """The double layer matrix."""
        return own(self._of.k())

    @cached_property
    def W(self):
        """The hypersingular matrix."""
        return own(self._of.w())

    @cached_property
    def M(self):
        """The mass matrix."""
        return own(self._of.m())

    @cached_property
    def _interior(self):
        return self.steklov()

    @property
    def S(self):
        """The Steklov-Poincaré matrix of the body itself, `steklov().matrix`."""
        return self._interior.matrix

    def steklov(self, domain="interior", bounded_at_infinity=False):
        """The Steklov-Poincaré matrix S = W + H^T V^-1 H, H = M/2 + K, with its tractions t: V t = H u.

        `domain="exterior"` is the plane around a body, H = M/2 - K. In an unbounded domain displacements decay at infinity, or grow like
        log(L/r) with a net force; `bounded_at_infinity` lets them tend to a constant, without a net force.
        """
        word("domain", domain, ["interior", "exterior"])
        if not isinstance(bounded_at_infinity, (bool, numpy.bool_)):
            raise BlockError(f"bounded_at_infinity is {bounded_at_infinity!r}: it is True or False")
        bounded = self.mesh.polygon.bounded
        if domain == "exterior" and not bounded:
            raise BlockError("domain is 'exterior' of a plane around holes: that is not one body; take 'interior' for the plane")
        if domain == "interior" and bounded and bounded_at_infinity:
            raise BlockError("bounded_at_infinity is of unbounded domains, the body is bounded: take False, or the exterior")
        return Steklov(self._of.steklov(domain, bool(bounded_at_infinity)))


class Steklov:
    """A Steklov-Poincaré operator: `matrix` (2 n, 2 n) maps nodal displacements to nodal forces (stress), symmetric; rigid motions are
    the kernel of that of a bounded body. Of the exterior the forces are -S u, for normals out of the body."""

    def __init__(self, of):
        self._of = of
        self.matrix = own(of.matrix())

    def _displacement(self, displacement):
        given, n = numbers("displacement", displacement), len(self.matrix) // 2
        if given.shape not in [(2 * n,), (n, 2)]:
            raise BlockError(f"displacement has the shape {given.shape}: it must be ({2 * n},) or ({n}, 2), x and y of each node")
        return given.ravel().tolist()

    def traction(self, displacement):
        """Legendre coefficients (2 n,) of the traction of a nodal displacement, (2 n,) or (n, 2)."""
        return self._of.traction(self._displacement(displacement))

    def at_infinity(self, displacement):
        """The constant (2,) to which the displacement tends; 0 unless the domain is `bounded_at_infinity`."""
        return numpy.array(self._of.at_infinity(self._displacement(displacement)))


_SOLVERS = ["interior-point", "newton", "active-set", "fixed-point", "uzawa"]


class ContactAnswer:
    """What a contact solver found, converged or not: `converged` holds if it reached its criterion and the judge finds all conditions
    fulfilled to 1e-6.

    `displacement` (m,), `multipliers` (k, 2): pressure and shear of each condition; `status` (k,): 0 apart, 1 stick, 2 and 3 slip along
    and against the tangent; `iterations`; `converged`; `outcome`: "converged", "iteration limit" or "diverged"; `history`: the solver's
    measure of its error. `kkt` has the judge's measures, see ContactProblem.kkt.
    """

    def __init__(self, of, problem):
        self._of = of
        for name, part in of.parts().items():
            setattr(self, name, own(part) if isinstance(part, numpy.ndarray) else part)
        self.kkt = problem._of.kkt(self.displacement.tolist(), self.multipliers.tolist())
        self.converged = self.outcome == "converged" and self.kkt["worst"] <= 1e-6

    def __repr__(self):
        return f"<blocks.ContactAnswer: {self.outcome} after {self.iterations} iterations, KKT {self.kkt['worst']:.1e}>"


class ContactProblem:
    """A contact problem condensed to its contact nodes: find v with

    S v + B^T λ = f,   u_n = normal · v_i <= gap,   λ_n >= 0,   λ_n (gap - u_n) = 0,
    u_t = tangent · v_i + slip,   |λ_t| <= F = bound + coefficient λ_n,   λ_t u_t = F |u_t|

    `stiffness` S (m, m) symmetric and positive semi-definite, `load` f (m,). Every node has two unknowns, those of
    node i being 2 i and 2 i + 1, or a single one if `unknowns=1`; a list of 1 and 2 has as many at each node. Each of k conditions is at
    the node `node[k]`, rising; by default one at each node. The others are (k,) or one for all:
    `gap` and `slip` (length), `weight` = ∫ of the node's function (length), `tangent_weight`, by default the same, `bound` of Tresca's law
    (stress, infinite for full stick) and `coefficient` of Coulomb's. `normal` (k, 2) is (1, 0) and `tangent` that turned by 90° unless
    given. The force of a condition on its node is -weight λ_n normal - tangent_weight λ_t tangent. Where all nodes have one unknown,
    normals are 1 or -1 (k,) and there is no friction; beside nodes of two, those of one have directions (±1, 0), and no tangent unless it
    is given. A node of two unknowns has up to two conditions.
    """

    def __init__(self, stiffness, load, gap, *, node=None, weight=1.0, tangent_weight=None, normal=None, tangent=None, slip=0.0, bound=0.0,
                 coefficient=0.0, unknowns=2):
        stiffness = numbers("stiffness", stiffness, (None, None))
        m = len(stiffness)
        numbers("stiffness", stiffness, (m, m))
        load = numbers("load", load, (m,))
        if m == 0:
            raise BlockError("stiffness has no rows: a problem has at least one node")
        each = self._unknowns(unknowns, m)
        node = numpy.arange(len(each)) if node is None else array("node", node)
        if node.ndim != 1 or node.size and node.dtype.kind not in "iu":
            raise BlockError(f"node is an array of {node.dtype} of the shape {node.shape}: it lists the node of each condition")
        node, k = [count(f"node[{i}]", n) for i, n in enumerate(node.tolist())], len(node)
        if max(node, default=0) >= len(each):
            raise BlockError(f"node has {max(node)}: nodes count from 0 below {len(each)}")
        # conditions at nodes of one unknown
        single = each[node] == 1
        rows = numpy.zeros((k, 10))
        rows[:, 4] = spread("weight", weight, (k,))
        rows[:, 6], rows[:, 7] = spread("gap", gap, (k,)), spread("slip", slip, (k,))
        rows[:, 8], rows[:, 9] = spread("bound", bound, (k,), infinite=True), spread("coefficient", coefficient, (k,))
        if each.max() == 1:
            if tangent is not None or tangent_weight is not None or rows[:, 7:].any():
                raise BlockError("nodes of one unknown have no tangent: leave out tangent, tangent_weight, slip, bound and coefficient")
            rows[:, 0] = spread("normal", 1.0 if normal is None else normal, (k,))
        else:
            rows[:, :2] = spread("normal", [1.0, 0.0] if normal is None else normal, (k, 2))
            turned = numpy.where(single, 0.0, [-rows[:, 1], rows[:, 0]]).T
            rows[:, 2:4] = turned if tangent is None else spread("tangent", tangent, (k, 2))
            same = numpy.where(single, 0.0, rows[:, 4])
            rows[:, 5] = same if tangent_weight is None else spread("tangent_weight", tangent_weight, (k,))
        self._of = _steklov.ContactProblem(stiffness, load.tolist(), each.tolist(), node, rows)
        self._sizes = m, k

    @staticmethod
    def _unknowns(unknowns, m):
        """The number of unknowns of each node."""
        given = array("unknowns", unknowns)
        if given.ndim == 0:
            one = count("unknowns", unknowns, 1)
            given = numpy.full(max(m // one, 1), one)
        if given.ndim != 1 or given.dtype.kind not in "iu" or not numpy.isin(given, [1, 2]).all() or given.sum() != m:
            raise BlockError(f"unknowns is {unknowns!r}: a node has 1 or 2, one number for all or one for each, together {m}")
        return given

    def _state(self, displacement, multipliers):
        m, k = self._sizes
        return numbers("displacement", displacement, (m,)).tolist(), numbers("multipliers", multipliers, (k, 2)).tolist()

    def solve(self, solver="interior-point", *, start=None, step=None):
        """The answer of a solver, a ContactAnswer.

        "interior-point" is the safest. "newton" (semi-smooth), "active-set", "fixed-point" (Coulomb's law as a row of Tresca problems) and
        "uzawa" go out from `start`, an answer or a pair of displacement and multipliers; "uzawa" takes a `step`, by default a safe one.
        """
        word("solver", solver, _SOLVERS)
        if start is not None:
            if solver == "interior-point":
                raise BlockError("start has no use for 'interior-point': leave it out, or take 'newton'")
            try:
                pair = (start.displacement, start.multipliers) if isinstance(start, ContactAnswer) else tuple(start)
                displacement, multipliers = pair
            except (TypeError, ValueError):
                raise BlockError("start is no pair: give an answer, or a displacement and multipliers") from None
            start = self._state(displacement, multipliers)
        if step is not None:
            if solver != "uzawa":
                raise BlockError(f"step is of 'uzawa', not of {solver!r}: leave it out")
            step = number("step", step)
        return ContactAnswer(self._of.solve(solver, start, step), self)

    def kkt(self, displacement, multipliers):
        """The relative violations of all conditions by an answer, whatever computed it: a dictionary of `equilibrium`, `penetration`,
        `tension`, `complementarity`, `friction`, and the `worst` of them."""
        return self._of.kkt(*self._state(displacement, multipliers))

    def energy(self, displacement, multipliers):
        """½ v·S v - f·v + Σ tangent_weight F |u_t|, F that of the multipliers."""
        return self._of.energy(*self._state(displacement, multipliers))

    def contraction(self, answer):
        """The contraction of the fixed point of Tresca problems at an answer: the largest modulus of its eigenvalues, below 1 where it
        converges, and the largest positive real one, above 1 where other solutions are to be expected."""
        if self._sizes != (of_kind("answer", answer, ContactAnswer).displacement.size, len(answer.multipliers)):
            raise BlockError("answer is one of another problem: solve this one")
        return self._of.contraction(answer._of)


class KarhunenLoeve:
    """Karhunen-Loève expansion of a random field of variance 1 on [0, L], or on [0, L1] x [0, L2]:

    κ(x) = Σ √λ_m b_m(x) ξ_m,   ∫ C(x - y) b_m(y) dy = λ_m b_m(x),   ∫ b_m b_n = δ_mn

    `kernel` "exponential": C = exp(-r/ℓ); "gaussian": exp(-(r/ℓ)^2); on rectangles products over both directions; "matern" with a
    `smoothness` from 0.5 to 10. `correlation` is ℓ, or one for each direction; `size` is L, or (L1, L2). It ends after so many `modes`, or
    where the share `captured` of the variance is reached.

    `eigenvalues` (M,): λ_m, falling, a length or an area; they sum up to the size. `captured`: the share of the variance in them.
    """

    def __init__(self, kernel, correlation, size, *, modes=None, captured=None, smoothness=None):
        word("kernel", kernel, ["exponential", "gaussian", "matern"])
        if (smoothness is None) == (kernel == "matern"):
            raise BlockError(f"smoothness is {smoothness!r} and kernel {kernel!r}: 'matern' takes one from 0.5 to 10, the others none")
        sides = numpy.atleast_1d(numbers("size", size))
        if sides.shape not in [(1,), (2,)]:
            raise BlockError(f"size has the shape {sides.shape}: it is the length of an interval or two sides of a rectangle")
        correlation = spread("correlation", correlation, (len(sides),))
        if (modes is None) == (captured is None):
            raise BlockError("an expansion ends by modes or by captured: give one of both")
        modes = None if modes is None else count("modes", modes, 1)
        captured = None if captured is None else number("captured", captured)
        smoothness = 1.5 if smoothness is None else number("smoothness", smoothness)
        both = [float(correlation[0]), float(correlation[-1])]
        self._of = _steklov.KarhunenLoeve(kernel, smoothness, both, sides.tolist(), modes, captured)
        self.size = own(sides)
        self.eigenvalues = own(self._of.eigenvalues())
        self.captured = self._of.captured()

    def __len__(self):
        return len(self.eigenvalues)

    def _points(self, name, points):
        """Points as rows, and the axes they had."""
        points, d = numbers(name, points), len(self.size)
        if d == 2 and (points.ndim == 0 or points.shape[-1] != 2):
            raise BlockError(f"{name} has the shape {points.shape}: on a rectangle the last axis has x and y")
        axes = points.shape[:-1] if d == 2 else points.shape
        return numpy.ascontiguousarray(points.reshape(-1, d)), axes

    def modes(self, points):
        """b_m at points of the interval, an array of any shape, or of the rectangle, with x and y on the last axis: an array of their axes
        and one of M."""
        rows, axes = self._points("points", points)
        out = numpy.argwhere((rows < -1e-12 * self.size) | (rows > (1 + 1e-12) * self.size))
        if len(out):
            ends = " x ".join(f"[0, {side}]" for side in self.size)
            raise BlockError(f"the point {rows[out[0][0]].tolist()} lies outside of {ends}: move it inside")
        return self._of.modes(rows).reshape(*axes, len(self))

    def covariance(self, distances):
        """C itself, at differences of two points."""
        rows, axes = self._points("distances", distances)
        return self._of.covariance(rows).reshape(axes)

    def __repr__(self):
        return f"<blocks.KarhunenLoeve: {len(self)} modes, {self.captured:.1%} of the variance>"


class CellBasis(NamedTuple):
    """The multiscale basis of a coarse cell of m x n fine ones.

    `nodes` (m+1, n+1, 2): the points. `values` (m+1, n+1, 2, 4, 2): component i of the function of corner p and direction k at
    [:, :, i, p, k]; corners are (0, 0), (L1, 0), (L1, L2), (0, L2). `stiffness` (8, 8): R^T K R with the stiffness K of the fine cells,
    unknown 2 p + k (stress). `tensor` (3, 3): U_a · stiffness U_b over the area, U_a the displacement of the corners by the unit strain
    xx, yy or 2 xy: energies; of "periodic" the homogenised tensor (stress).
    """

    nodes: numpy.ndarray
    values: numpy.ndarray
    stiffness: numpy.ndarray
    tensor: numpy.ndarray


def cell_basis(young, kind="oscillatory", *, poisson=0.3, size=(1.0, 1.0), plane="strain", layers=None):
    """The multiscale basis of one coarse cell: functions with div σ = 0 on its fine cells, that are the bilinear ones at the corners.

    `young` (m, n): Young's modulus of fine cell [i, j], i along x, j along y; `poisson`: one ratio, or (m, n); `size`: the sides of the
    coarse cell.

    "q1": the bilinear functions themselves. "linear": component k bilinear on the boundary, where the other one is free of traction, and is
    dropped then. "coupled": component k bilinear on the boundary, the other one 0 there. "oscillatory": as coupled, but along each edge
    (E φ')' = 0, with E/(1-ν²) in place of E where ratios differ. "periodic": bilinear and a periodic part, whose tensor is
    the homogenised one. "oversampled": coupled on the cell and `layers` of fine cells around it, whose moduli `young` has as well:
    (m + 2 layers, n + 2 layers).
    """
    word("kind", kind, ["q1", "linear", "coupled", "oscillatory", "periodic", "oversampled"])
    if (layers is None) == (kind == "oversampled"):
        raise BlockError(f"layers is {layers!r} and kind {kind!r}: 'oversampled' takes 1 or more, the others none")
    around = 0 if layers is None else count("layers", layers, 1)
    word("plane", plane, ["strain", "stress"])
    young = numbers("young", young, (None, None))
    ratios = numbers("poisson", poisson)
    ratios = numbers("poisson", ratios if ratios.ndim else [[ratios]], (1, 1) if not ratios.ndim else young.shape)
    sides = numbers("size", size, (2,))
    values, stiffness, tensor = _steklov.cell_basis(kind, young, ratios, sides.tolist(), plane, around)
    x, y = (numpy.linspace(0.0, side, n + 1) for side, n in zip(sides, numpy.subtract(young.shape, 2 * around)))
    nodes = numpy.stack(numpy.meshgrid(x, y, indexing="ij"), axis=-1)
    return CellBasis(nodes, numpy.ascontiguousarray(values.transpose(1, 0, 2, 3, 4)), stiffness, tensor)
