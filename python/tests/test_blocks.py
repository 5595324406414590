"""The building blocks, each judged by an identity or a closed form."""

import math
import threading
import time

import numpy
import pytest

import steklov
from steklov import blocks

SQUARE = ([[0, 0], [2, 0], [2, 1], [0, 1]], ["floor", "right", "top", "left"])
YOUNG, POISSON = 200.0, 0.3
MU = YOUNG / (2 * (1 + POISSON))
LAMBDA = 2 * MU * POISSON / (1 - 2 * POISSON)


def block(elements=10, degree=3):
    return blocks.Mesh.uniform(blocks.Polygon(*SQUARE), elements, degree)


@pytest.fixture(scope="module")
def operators():
    return blocks.Operators(block(), YOUNG, POISSON)


def rigid(nodes):
    x, y = nodes.T
    return numpy.stack([numpy.ones_like(x), 0 * x, 0 * x, numpy.ones_like(x), -y, x]).reshape(3, 2, -1).transpose(0, 2, 1).reshape(3, -1)


# rules


@pytest.mark.parametrize("kind, n, degree", [("gauss", 1, 1), ("gauss", 6, 11), ("lobatto", 2, 1), ("lobatto", 6, 9), ("jacobi", 5, 9)])
def test_rules_are_exact_to_their_degree_and_no_higher(kind, n, degree):
    rule = blocks.rule(kind, n)
    assert rule.degree == degree and len(rule.points) == len(rule.weights) == n
    error = [rule.weights @ rule.points**k - (1 + (-1) ** k) / (k + 1) for k in range(degree + 2)]
    assert max(map(abs, error[:-1])) < 3e-15
    assert 1e-5 < abs(error[-1]) < 2.1
    assert numpy.all(numpy.diff(rule.points) > 0) and numpy.all(rule.weights > 0)


def test_a_jacobi_rule_has_its_weight():
    # ∫ (1-x)^½ (1+x)^-½ dx = π, and times 1+x it is π/2
    rule = blocks.rule("jacobi", 4, alpha=0.5, beta=-0.5)
    assert abs(rule.weights.sum() - math.pi) < 1e-14 and abs(rule.weights @ (1 + rule.points) - math.pi / 2) < 1e-14
    assert blocks.rule("jacobi", 1000, alpha=50, beta=-0.999).weights.min() >= 0


def test_rules_for_logarithms():
    # ∫_0^1 log x = -1: each layer divides the error by the ratio
    errors = [blocks.rule("graded", 12, layers=k, ratio=0.3, end="zero") for k in (4, 5)]
    errors = [abs(rule.weights @ numpy.log(rule.points) + 1) for rule in errors]
    assert abs(errors[1] / errors[0] / 0.3 - 1) < 1e-6
    # next to ±1 numbers do not hold smaller distances than 1e-16
    both = [blocks.rule("graded", 12, layers=k, end="both") for k in (4, 30)]
    errors = [abs(rule.weights @ numpy.log(1 - rule.points**2) - (4 * math.log(2) - 4)) for rule in both]
    assert errors[0] > 1e-7 and errors[1] < 1e-9
    left, right = (blocks.rule("graded", 3, end=end) for end in ("left", "right"))
    assert numpy.array_equal(left.points, -right.points[::-1])
    smooth = blocks.rule("logarithmic", 20)
    assert abs(smooth.weights @ numpy.log(smooth.points) + 1) < 1e-11 and smooth.degree == 7
    assert abs(blocks.rule("logarithmic", 20, power=1).weights @ numpy.log(blocks.rule("logarithmic", 20, power=1).points) + 1) > 1e-4


# boundaries


def test_polygons_know_their_measures():
    hole = blocks.Loop([[0.5, 0.25], [1, 0.25], [1, 0.75], [0.5, 0.75]], ["hole"] * 4)
    polygon = blocks.Polygon(*SQUARE, [hole])
    assert (polygon.area, polygon.edges, polygon.sides) == (1.75, 8, ["floor", "right", "top", "left", "hole"])
    assert abs(polygon.diameter - math.sqrt(5)) < 1e-15 and polygon.bounded
    assert numpy.allclose(polygon.centroid, [(2 - 0.25 * 0.75) / 1.75, 0.5], rtol=0, atol=1e-15)
    disc = blocks.Polygon(blocks.circle([1, 2], 3, "rim"))
    assert abs(disc.area - 9 * math.pi) < 1e-13 and abs(disc.diameter - 6) < 1e-14
    half = blocks.Polygon([[0, 0], [2, 0]], ["base", "arc"], turns=[0, math.pi])
    assert abs(half.area - math.pi / 2) < 1e-15
    plane = blocks.Polygon.outside([blocks.circle([0, 0], 1, "rim")])
    assert plane.area == math.inf and not plane.bounded


def test_meshes_are_closed_loops():
    mesh = blocks.Mesh.uniform(blocks.Polygon(*SQUARE, [blocks.circle([1, 0.5], 0.25, "hole")]), 24, 2)
    assert len(mesh) == 24 and mesh.ends.shape == (24, 2, 2) and sorted(mesh.next) == list(range(24))
    assert numpy.array_equal(mesh.ends[:, 1], mesh.ends[mesh.next, 0])
    assert numpy.array_equal(mesh.nodes[mesh.offset[:-1]], mesh.ends[:, 0]) and mesh.offset[-1] == len(mesh.nodes) == 48
    assert abs(mesh.length.sum() - (6 + math.pi / 2)) < 1e-13
    on = [mesh.sides[k] for k in mesh.side]
    assert numpy.array_equal(mesh.normal[on.index("floor")], [0, -1])
    at = on.index("hole")
    # into the hole
    assert mesh.normal[at] @ (numpy.array([1, 0.5]) - mesh.ends[at].mean(axis=0)) > 0
    with pytest.raises(ValueError, match="read-only"):
        mesh.nodes[0] = 0


def test_meshes_are_refined():
    mesh = block(6, 2)
    finer, parents = mesh.halved([0, 3])
    assert len(finer) == 8 and parents.tolist() == [0, 0, 1, 2, 3, 3, 4, 5]
    assert numpy.array_equal(finer.ends[1, 0], mesh.ends[0].mean(axis=0))
    assert mesh.raised(mesh.side == 0).degree.tolist() == [3 if side == 0 else 2 for side in mesh.side]
    graded = blocks.Mesh.graded(mesh.polygon, [(0, 0)], 4, ratio=0.25, degree=[1, 2, 3, 4, 5])
    floor = graded.length[graded.side == 0]
    assert numpy.allclose(floor, 2 * numpy.array([1 / 256, 3 / 256, 3 / 64, 3 / 16, 3 / 4]), rtol=1e-13)
    assert graded.degree[graded.side == 0].tolist() == [1, 2, 3, 4, 5]


# operators


def test_matrices_have_their_symmetries(operators):
    n = 2 * len(operators.mesh.nodes)
    for name in "VKWMS":
        assert getattr(operators, name).shape == (n, n), name
    assert numpy.array_equal(operators.V, operators.V.T) and numpy.array_equal(operators.S, operators.S.T)
    assert numpy.linalg.eigvalsh(operators.V)[0] > 0
    assert numpy.linalg.eigvalsh(operators.W)[0] > -1e-12 * YOUNG and not operators.V.flags.writeable


def test_rigid_motions_are_in_the_kernels(operators):
    scale = abs(operators.S).max()
    for r in rigid(operators.mesh.nodes):
        assert abs(operators.K @ r + 0.5 * operators.M @ r).max() < 1e-13
        assert abs(operators.W @ r).max() < 1e-12 * scale and abs(operators.S @ r).max() < 1e-12 * scale
    assert numpy.sum(numpy.linalg.eigvalsh(operators.S) < 1e-10 * scale) == 3


def linear(mesh, gradient, material):
    """A linear displacement at the nodes, and the Legendre coefficients of its traction."""
    mu, lame = material
    stress = lame * numpy.trace(gradient) * numpy.eye(2) + mu * (gradient + gradient.T)
    traction = numpy.zeros((len(mesh.nodes), 2))
    traction[mesh.offset[:-1]] = mesh.normal @ stress
    return (mesh.nodes @ gradient.T).ravel(), traction.ravel(), stress


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_linear_displacements_have_their_tractions(plane):
    nu = POISSON if plane == "strain" else POISSON / (1 + POISSON)
    operators = blocks.Operators(block(), YOUNG, POISSON, plane)
    material = MU, 2 * MU * nu / (1 - 2 * nu)
    u, t, stress = linear(operators.mesh, numpy.array([[1.0, 0.3], [-0.1, 0.0]]), material)
    assert abs(operators.S @ u - operators.M.T @ t).max() < 1e-11 * abs(t).max()
    assert abs(operators.steklov().traction(u) - t).max() < 1e-10 * abs(t).max()
    assert abs(u @ operators.S @ u / (2 * (stress[0, 0] + 0.2 * stress[0, 1])) - 1) < 1e-11
    # the other plane is another material
    other = blocks.Operators(operators.mesh, YOUNG, POISSON, {"strain": "stress", "stress": "strain"}[plane])
    assert abs(other.S @ u - operators.M.T @ t).max() > 1e-2 * abs(t).max()


def test_stretching_has_lambda_and_two_mu(operators):
    u, t, stress = linear(operators.mesh, numpy.array([[1.0, 0.0], [0.0, 0.0]]), (MU, LAMBDA))
    assert abs(stress[0, 0] - (LAMBDA + 2 * MU)) < 1e-12
    right = operators.mesh.side == operators.mesh.sides.index("right")
    found = operators.steklov().traction(u).reshape(-1, 2)[operators.mesh.offset[:-1][right]]
    assert numpy.allclose(found, [LAMBDA + 2 * MU, 0], rtol=0, atol=1e-10 * YOUNG)


def test_a_hole_under_pressure_widens_by_its_formula():
    # u_r = p a / (2 μ) for a round hole of radius a in the plane
    mesh = blocks.Mesh.uniform(blocks.Polygon.outside([blocks.circle([0, 0], 2, "rim")]), 8, 8)
    operators = blocks.Operators(mesh, YOUNG, POISSON)
    u = (mesh.nodes / 2).ravel()
    radial = u @ operators.steklov(bounded_at_infinity=True).matrix @ u / (2 * math.pi * 2)
    assert abs(radial / (2 * MU / 2) - 1) < 1e-9
    # the same plane is the exterior of the disc
    disc = blocks.Operators(blocks.Mesh.uniform(blocks.Polygon(blocks.circle([0, 0], 2, "rim")), 8, 8), YOUNG, POISSON)
    exterior = disc.steklov("exterior", bounded_at_infinity=True)
    v = (disc.mesh.nodes / 2).ravel()
    assert abs(v @ exterior.matrix @ v / (2 * math.pi * 2) / (2 * MU / 2) - 1) < 1e-9
    shift = numpy.tile([3.0, -1.0], len(mesh.nodes))
    assert numpy.allclose(exterior.at_infinity(v + shift), [3, -1], rtol=0, atol=1e-9)
    assert abs(exterior.matrix @ shift).max() < 1e-9 * abs(exterior.matrix).max()


def test_other_threads_run_while_operators_are_assembled():
    counted, running = [0], [True]

    def count():
        while running[0]:
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.perf_counter()
    blocks.Operators(block(160, 4), YOUNG, POISSON).steklov()
    seconds, during = time.perf_counter() - start, counted[0]
    running[0] = False
    thread.join()
    # of a thousand a second on an idle machine
    assert during > 50 * seconds, (during, seconds)


# contact


@pytest.mark.parametrize("solver", ["interior-point", "newton", "active-set", "fixed-point", "uzawa"])
def test_two_springs_against_a_wall(solver):
    # u_1 = gap = 1, 2 u_2 = u_1, and weight λ = 3 - 2 + 1/2
    problem = blocks.ContactProblem([[2, -1], [-1, 2]], [3, 0], [1, 10], weight=[2, 1], unknowns=1)
    answer = problem.solve(solver)
    assert answer.converged and answer.outcome == "converged" and answer.iterations == int(answer.iterations)
    assert numpy.allclose(answer.displacement, [1, 0.5], rtol=0, atol=1e-9)
    assert numpy.allclose(answer.multipliers, [[0.75, 0], [0, 0]], rtol=0, atol=1e-9)
    assert answer.kkt["worst"] < 1e-9 and answer.status[1] == 0 != answer.status[0]
    assert abs(problem.energy(answer.displacement, answer.multipliers) - (0.75 - 3)) < 1e-8
    # the judge sees what is wrong
    assert problem.kkt([1.1, 0.55], answer.multipliers)["penetration"] > 0.008
    assert problem.kkt(answer.displacement, [[0.8, 0], [0, 0]])["equilibrium"] > 0.01
    assert problem.kkt(answer.displacement, -answer.multipliers)["tension"] == 1


@pytest.mark.parametrize("solver", ["interior-point", "newton", "active-set", "fixed-point", "uzawa"])
def test_three_nodes_under_coulombs_law(solver):
    chain = numpy.array([[3, -1, 0], [-1, 4, -1], [0, -1, 3]])
    problem = blocks.ContactProblem(numpy.kron(chain, numpy.eye(2)), [4, -2, 3, 12, -3, 0], 0, coefficient=0.5)
    answer = problem.solve(solver)
    assert numpy.allclose(answer.displacement, [0, 0, 0, 3, -1, 1], rtol=0, atol=1e-9)
    assert numpy.allclose(answer.multipliers, [[4, 1], [2, 1], [0, 0]], rtol=0, atol=1e-9)
    assert answer.status.tolist() == [1, 2, 0] and answer.kkt["worst"] < 1e-9
    # shear does not change the pressure of this chain
    assert max(problem.contraction(answer)) < 1e-12
    if solver not in ("interior-point", "uzawa"):
        again = problem.solve(solver, start=answer)
        assert again.iterations <= answer.iterations and numpy.allclose(again.displacement, answer.displacement, rtol=0, atol=1e-12)


def test_coupled_friction_contracts():
    # one node with S = [[2, s], [s, 2]]: λ_n = f_n - s u_t, u_t = (f_t - μ λ_n)/2, so that the pressure changes by μ s/2
    for mu, s in [(0.3, -1.5), (0.4, 1.0)]:
        problem = blocks.ContactProblem([[2, s], [s, 2]], [9, 4], 0, coefficient=mu)
        answer = problem.solve()
        pressure = (9 - 2 * s) / (1 - mu * s / 2)
        assert answer.status.tolist() == [2] and numpy.allclose(answer.multipliers, [[pressure, mu * pressure]], rtol=1e-11)
        factor, real = problem.contraction(answer)
        assert abs(factor - abs(mu * s / 2)) < 1e-12 and abs(real - max(mu * s / 2, 0)) < 1e-12
    # where a step is too long it is told
    far = blocks.ContactProblem(numpy.eye(2), [4, 0], 0).solve("uzawa", step=1e9)
    assert not far.converged and far.outcome == "diverged"


def test_friction_and_full_stick():
    spring = {"stiffness": 4 * numpy.eye(2), "load": [6, 1.5], "gap": 1}
    slip = blocks.ContactProblem(**spring, bound=0.5).solve()
    assert numpy.allclose(slip.displacement, [1, 0.25], rtol=0, atol=1e-12) and slip.status.tolist() == [2]
    stick = blocks.ContactProblem(**spring, bound=math.inf).solve()
    assert numpy.allclose(stick.displacement, [1, 0], rtol=0, atol=1e-12) and numpy.allclose(stick.multipliers, [[2, 1.5]])
    # beside a node with one unknown, which is without friction
    both = blocks.ContactProblem(4 * numpy.eye(3), [6, 6, 1.5], 1, unknowns=[1, 2], bound=0.5).solve()
    assert numpy.allclose(both.displacement, [1, 1, 0.25], rtol=0, atol=1e-12)
    assert numpy.allclose(both.multipliers, [[2, 0], [2, 0.5]], rtol=0, atol=1e-12)
    # held along its normal, a node has friction alone
    rubbed = blocks.ContactProblem(
        4 * numpy.eye(3), [6, 1.5, 1.5], 1, unknowns=[2, 1], weight=[1, 0], tangent=[[0, 1], [1, 0]], tangent_weight=[1, 1], bound=0.5
    ).solve()
    assert numpy.allclose(rubbed.displacement, [1, 0.25, 0.25], rtol=0, atol=1e-12)
    # a corner: walls at 1 along x and at 2 along y
    corner = blocks.ContactProblem(4 * numpy.eye(2), [6, 12], [1, 2], node=[0, 0], normal=[[1, 0], [0, 1]]).solve()
    assert numpy.allclose(corner.displacement, [1, 2], rtol=0, atol=1e-12)
    assert numpy.allclose(corner.multipliers[:, 0], [2, 4], rtol=0, atol=1e-12)


def test_a_block_is_pressed_on_a_floor(operators):
    # held along x on its left: σ_yy = -p, σ_xx = 0, u = p (1+ν)/E (ν x, -(1-ν) y)
    pressure, mesh, n = 1.5, operators.mesh, len(operators.mesh.nodes)
    load = numpy.zeros((n, 2))
    top = mesh.offset[:-1][mesh.side == mesh.sides.index("top")]
    load[top] = [0, -pressure]
    load = operators.M.T @ load.ravel()
    floor = numpy.flatnonzero(mesh.nodes[:, 1] == 0)
    kept, held = 2 * floor + 1, 2 * numpy.flatnonzero(mesh.nodes[:, 0] == 0)
    free = numpy.setdiff1d(numpy.arange(2 * n), numpy.concatenate([kept, held]))
    inner = numpy.linalg.solve(operators.S[numpy.ix_(free, free)], numpy.column_stack([operators.S[numpy.ix_(free, kept)], load[free]]))
    stiffness = operators.S[numpy.ix_(kept, kept)] - operators.S[numpy.ix_(kept, free)] @ inner[:, :-1]
    on_floor = 2 * mesh.offset[:-1][mesh.side == mesh.sides.index("floor")] + 1
    weight = operators.M[numpy.ix_(on_floor, kept)].sum(axis=0)
    assert abs(weight.sum() - 2) < 1e-14
    condensed = load[kept] - operators.S[numpy.ix_(kept, free)] @ inner[:, -1]
    stiffness = (stiffness + stiffness.T) / 2
    answer = blocks.ContactProblem(stiffness, condensed, 0, weight=weight, normal=-1, unknowns=1).solve()
    assert numpy.allclose(answer.multipliers[:, 0], pressure, rtol=0, atol=1e-10) and answer.kkt["worst"] < 1e-10
    u = inner[:, -1] - inner[:, :-1] @ answer.displacement
    exact = pressure * (1 + POISSON) / YOUNG * mesh.nodes * [POISSON, -(1 - POISSON)]
    assert numpy.allclose(u, exact.ravel()[free], rtol=0, atol=1e-13)


# random fields


def exponential(count, length):
    """λ_m = 2ℓ/(1 + ℓ²ω²), θ = ω/2 with θ tan θ = q or θ + q tan θ = 0, q = 1/(2ℓ)."""
    q, values = 0.5 / length, []
    for m in range(count):
        low, high = m * math.pi / 2, (m + 1) * math.pi / 2
        for _ in range(60):
            theta = (low + high) / 2
            above = theta * math.tan(theta) > q if m % 2 == 0 else theta + q * math.tan(theta) > 0
            low, high = (low, theta) if above else (theta, high)
        values.append(2 * length / (1 + (length * (low + high)) ** 2))
    return numpy.array(values)


def test_eigenvalues_of_the_exponential_covariance():
    field = blocks.KarhunenLoeve("exponential", 0.5, 1.0, modes=12)
    exact = exponential(12, 0.5)
    assert abs(field.eigenvalues / exact - 1).max() < 1e-11 and len(field) == 12
    assert abs(field.eigenvalues[0] - 0.5746552) < 5.1e-8 and abs(field.captured - exact.sum()) < 1e-11
    longer = blocks.KarhunenLoeve("exponential", 1.0, 2.0, modes=12)
    assert numpy.allclose(longer.eigenvalues, 2 * exact, rtol=1e-11)
    square = blocks.KarhunenLoeve("exponential", [0.5, 1.0], [1.0, 2.0], modes=3)
    assert numpy.allclose(square.eigenvalues, 2 * exact[0] * numpy.array([exact[0], exact[1], exact[1]]), rtol=1e-11)


@pytest.mark.parametrize("kernel, more, size", [
    ("exponential", {}, 1.5), ("gaussian", {}, 1.5), ("matern", {"smoothness": 2.5}, 1.5), ("gaussian", {}, [1.5, 1.0]),
    ("matern", {"smoothness": 1.5}, [1.5, 1.0]),
])
def test_modes_are_orthonormal_eigenfunctions(kernel, more, size):
    field = blocks.KarhunenLoeve(kernel, 0.8, size, modes=4, **more)
    rule, sides = blocks.rule("gauss", 40), numpy.atleast_1d(size)
    axes = [(1 + rule.points) / 2 * side for side in sides]
    points = axes[0] if len(sides) == 1 else numpy.stack(numpy.meshgrid(*axes, indexing="ij"), axis=-1)
    weights = rule.weights / 2 * sides[0]
    if len(sides) == 2:
        weights = numpy.multiply.outer(weights, rule.weights / 2 * sides[1])
    modes = field.modes(points)
    assert modes.shape == weights.shape + (4,)
    modes, weights = modes.reshape(-1, 4), weights.ravel()
    assert abs(modes.T @ (weights[:, None] * modes) - numpy.eye(4)).max() < 1e-10
    middle = points.reshape(-1, len(sides))[len(weights) // 2 + 17]
    differences = points - (middle if len(sides) == 2 else middle[0])
    found = (field.covariance(differences).ravel() * weights) @ modes
    at = field.modes(middle if len(sides) == 2 else middle[0])
    rough = 2e-3 if kernel != "gaussian" else 1e-12
    assert abs(found - field.eigenvalues * at).max() < rough
    assert abs(field.covariance(differences * 0) - 1).max() == 0


def test_an_expansion_ends_at_a_share():
    field = blocks.KarhunenLoeve("exponential", 0.5, 1.0, captured=0.95)
    assert len(field) == 9 and field.captured >= 0.95 > exponential(8, 0.5).sum()


# multiscale bases


KINDS = {"q1": {}, "linear": {}, "coupled": {}, "oscillatory": {}, "periodic": {}, "oversampled": {"layers": 1}}


@pytest.mark.parametrize("kind", KINDS)
def test_bases_are_partitions_of_unity(kind):
    young = numpy.where(numpy.random.default_rng(1).random((8, 6) if kind == "oversampled" else (6, 4)) < 0.4, 50.0, 1.0)
    basis = blocks.cell_basis(young, kind, size=(3.0, 1.0), **KINDS[kind])
    assert basis.values.shape == (7, 5, 2, 4, 2) and numpy.array_equal(basis.nodes[-1, 0], [3, 0])
    assert abs(basis.values.sum(axis=3) - numpy.eye(2)).max() < 1e-12
    corners = basis.values[[0, -1, -1, 0], [0, 0, -1, -1]]
    assert numpy.allclose(corners, numpy.einsum("ap,ik->aipk", numpy.eye(4), numpy.eye(2)), rtol=0, atol=1e-12)
    translations = numpy.tile(numpy.eye(2), (4, 1))
    assert abs(basis.stiffness @ translations).max() < 1e-11 * basis.stiffness.max()
    assert numpy.allclose(basis.stiffness, basis.stiffness.T, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_bases_of_a_homogeneous_cell_have_linear_functions(kind):
    basis = blocks.cell_basis(numpy.full((7, 5), YOUNG), kind, size=(2.0, 1.0), poisson=POISSON, **KINDS[kind])
    gradient = numpy.array([[0.3, -0.2], [0.7, 0.1]])
    at = numpy.array([[0, 0], [2, 0], [2, 1], [0, 1]]) @ gradient.T
    field = numpy.einsum("abipk,pk->abi", basis.values, at)
    if kind != "linear":  # which drops the other component
        assert abs(field - basis.nodes @ gradient.T).max() < 1e-12
        exact = [[LAMBDA + 2 * MU, LAMBDA, 0], [LAMBDA, LAMBDA + 2 * MU, 0], [0, 0, MU]]
        assert numpy.allclose(basis.tensor, exact, rtol=0, atol=1e-10 * YOUNG)
    # the modulus itself does not matter
    softer = blocks.cell_basis(numpy.ones((7, 5)), kind, size=(2.0, 1.0), poisson=POISSON, **KINDS[kind])
    assert abs(basis.values - softer.values).max() < 1e-12 and abs(basis.stiffness / YOUNG - softer.stiffness).max() < 1e-12


def test_a_laminate_has_its_homogenised_moduli():
    # layers across x without Poisson's ratio: the harmonic mean across, the arithmetic one along, half the harmonic one in shear
    young = numpy.repeat([[1.0], [9.0]], 3, axis=0) * numpy.ones(4)
    tensor = blocks.cell_basis(young, "periodic", poisson=0.0).tensor
    assert numpy.allclose(tensor, numpy.diag([1.8, 5.0, 0.9]), rtol=0, atol=1e-10)
    bounds = blocks.cell_basis(young, "coupled", poisson=0.0).tensor
    assert bounds[0, 0] > 1.81 and bounds[2, 2] > 0.91
    # along the lower edge 1 - ∫ 1/E / ∫ 1/E
    lower = blocks.cell_basis(young, "oscillatory", poisson=0.0).values[:, 0, 0, 0, 0]
    assert numpy.allclose(lower, 1 - numpy.array([0, 9, 18, 27, 28, 29, 30]) / 30, rtol=0, atol=1e-14)
    two = blocks.cell_basis(numpy.ones((2, 2)), "periodic", poisson=[[0.0, 0.3], [0.3, 0.0]]).tensor
    assert two[0, 1] > 0.01


def test_what_lies_around_a_cell_changes_its_oversampled_basis():
    soft = numpy.ones((8, 8))
    stiff = soft.copy()
    stiff[0, 0] = 100.0
    bases = [blocks.cell_basis(young, "oversampled", layers=2) for young in (soft, stiff)]
    assert bases[0].values.shape == (5, 5, 2, 4, 2) and abs(bases[0].values - bases[1].values).max() > 1e-3
    # nine times the same cell is not the cell alone
    alone = blocks.cell_basis(soft[:4, :4], "coupled")
    assert abs(bases[0].tensor - alone.tensor).max() < 1e-12 and abs(bases[0].values - alone.values).max() > 1e-3


# what is wrong


NAN, INF = math.nan, math.inf
SPRING = {"stiffness": 4 * numpy.eye(2), "load": [6, 1.5], "gap": 1}


def contact(**change):
    return blocks.ContactProblem(**{**SPRING, **change})


def kl(kernel="exponential", correlation=0.5, size=1.0, **more):
    return blocks.KarhunenLoeve(kernel, correlation, size, **(more or {"modes": 3}))


@pytest.mark.parametrize("make, told", [
    # rules
    (lambda: blocks.rule("gausss", 3), "did you mean 'gauss'"),
    (lambda: blocks.rule(3, 3), "kind is 3: it is one of"),
    (lambda: blocks.rule("gauss", 0), "n is 0"),
    (lambda: blocks.rule("gauss", -1), "n is -1"),
    (lambda: blocks.rule("gauss", 2.5), "n is 2.5: it is a whole number"),
    (lambda: blocks.rule("gauss", 2**40), r"below 2\^31"),
    (lambda: blocks.rule("gauss", 2**30), "takes 1 to 1000000 points"),
    (lambda: blocks.rule("lobatto", 1), "takes 2 to 1000 points"),
    (lambda: blocks.rule("jacobi", 3, alpha=-1), "alpha is -1"),
    (lambda: blocks.rule("jacobi", 3, beta=NAN), "beta is nan: it must be finite"),
    (lambda: blocks.rule("jacobi", 3, alpa=1), "did you mean 'alpha'"),
    (lambda: blocks.rule("gauss", 3, alpha=1), "takes n alone"),
    (lambda: blocks.rule("graded", 3, ratio=1), "ratio is 1"),
    (lambda: blocks.rule("graded", 3, layers=10**6), "take fewer layers"),
    (lambda: blocks.rule("graded", 3, end="lefd"), "did you mean 'left'"),
    (lambda: blocks.rule("logarithmic", 2, power=5), "power is 5"),
    # boundaries
    (lambda: blocks.Polygon([[0, 0], [1, 0]], ["a", "b"]), "2 corners"),
    (lambda: blocks.Polygon(SQUARE[0], ["a"]), "a name for each of 4 edges"),
    (lambda: blocks.Polygon(SQUARE[0], "abcd"), "lists a name for each edge"),
    (lambda: blocks.Polygon([[0, 0, 0]], ["a"]), r"shape \(1, 3\): it must be \(any, 2\)"),
    (lambda: blocks.Polygon([[0, 0], [1, NAN], [1, 1]], ["a"] * 3), r"outer.corners\[1\]\[1\] is nan"),
    (lambda: blocks.Polygon([[0, 0], [1], [1, 1]], ["a"] * 3), "rows of equal lengths"),
    (lambda: blocks.Polygon(SQUARE[0][::-1], SQUARE[1]), "counter-clockwise"),
    (lambda: blocks.Polygon(*SQUARE, [([[5, 5], [6, 5], [6, 6]], ["a"] * 3)]), "hole 1"),
    (lambda: blocks.Polygon(*SQUARE, [3]), r"holes\[0\] is 3"),
    (lambda: blocks.Polygon(*SQUARE, blocks.circle([1, 0.5], 0.1, "h")), "list the holes"),
    (lambda: blocks.Polygon(*SQUARE, turns=[0, 0, 7, 0]), "edge 2"),
    (lambda: blocks.Polygon(*SQUARE, turns=[0, 0]), r"outer.turns has the shape \(2,\)"),
    (lambda: blocks.Polygon.outside([]), "at least one"),
    (lambda: blocks.Polygon(numpy.array(SQUARE[0]) * 1e-150, SQUARE[1]), "the diameter is 2.2"),
    (lambda: blocks.Polygon(*SQUARE, 7), "holes is 7: it lists loops"),
    (lambda: blocks.Polygon(numpy.ones((60000, 2)), ["a"] * 60000), "60000 corners"),
    (lambda: blocks.circle([0, 0], -1, "rim"), "radius is -1"),
    (lambda: block(0), "elements is 0: it is at least 1"),
    (lambda: block(2**30), "elements is 1073741824"),
    (lambda: block(999_990, 1).halved(numpy.arange(11)), "more than 1000000 nodes"),
    (lambda: block(8, 0), "degree is 0"),
    (lambda: block(8, 65), "degrees from 1 to 64"),
    (lambda: block(8, 64).raised([0]), "degree 65"),
    (lambda: blocks.Mesh.uniform(SQUARE, 8, 2), "must be a blocks.Polygon"),
    (lambda: block().halved([10]), "they count from 0 below 10"),
    (lambda: block().halved([True] * 3), "10 truth values"),
    (lambda: block().raised([0.5]), "list elements"),
    (lambda: block().raised([[0], [1, 2]]), "different lengths"),
    (lambda: blocks.Mesh.graded(blocks.Polygon(*SQUARE), [(9, 0)], 3), "not on the boundary"),
    (lambda: blocks.Mesh.graded(blocks.Polygon(*SQUARE), [(0.5, 0)], 3), "whole number"),
    (lambda: blocks.Mesh.graded(blocks.Polygon(*SQUARE), [(0, 0)], 3, degree=[1, 2]), "one more"),
    (lambda: blocks.Mesh.graded(blocks.Polygon(*SQUARE), [(0, 0)], 900), "no length"),
    # operators
    (lambda: blocks.Operators(block(), -1, 0.3), "Young's modulus is -1"),
    (lambda: blocks.Operators(block(), 1e-310, 0.3), "change the unit"),
    (lambda: blocks.Operators(block(), 1, 0.5), r"\(-1, 1/2\)"),
    (lambda: blocks.Operators(block(), NAN, 0.3), "young is nan"),
    (lambda: blocks.Operators(block(), [1, 2], 0.3), r"young has the shape \(2,\)"),
    (lambda: blocks.Operators(block(), 1, 0.3, "strian"), "did you mean 'strain'"),
    (lambda: blocks.Operators(block(), 1, 0.3, length=0), "length is 0"),
    (lambda: blocks.Operators("mesh", 1, 0.3), "must be a blocks.Mesh"),
    (lambda: blocks.Operators(block(20000, 20), 1, 0.3), "GiB are free: take fewer elements"),
    (lambda: blocks.Operators(block(), 1, 0.3, length=1e-3).S, "length L = 0.001"),
    (lambda: blocks.Operators(block(), 1, 0.3).steklov("outside"), "it is one of 'interior', 'exterior'"),
    (lambda: blocks.Operators(block(), 1, 0.3).steklov(bounded_at_infinity=True), "the body is bounded"),
    (lambda: blocks.Operators(block(), 1, 0.3).steklov().traction([1, 2]), "x and y of each node"),
    (lambda: blocks.Operators(block(), 1, 0.3).steklov().traction([NAN] * 60), r"displacement\[0\] is nan"),
    # contact
    (lambda: contact(stiffness=numpy.ones((2, 3))), r"shape \(2, 3\): it must be \(2, 2\)"),
    (lambda: contact(stiffness=[[1, 2], [0, 1]]), "not symmetric"),
    (lambda: contact(stiffness=-numpy.eye(2)), "diagonal entry"),
    (lambda: contact(stiffness=numpy.zeros((0, 0)), load=[]), "at least one node"),
    (lambda: contact(stiffness=numpy.eye(3), load=[1, 2, 3]), "a node has 1 or 2, one number for all or one for each, together 3"),
    (lambda: contact(load=[1, INF]), r"load\[1\] is inf"),
    (lambda: contact(load=[1]), r"load has the shape \(1,\)"),
    (lambda: contact(gap=[1, 2]), r"gap has the shape \(2,\): it must be \(1,\), or one for all"),
    (lambda: contact(gap=NAN), "gap is nan"),
    (lambda: contact(bound=-1), "friction bound is -1"),
    (lambda: contact(bound=NAN), "bound is nan"),
    (lambda: contact(weight=-1), "a weight is -1"),
    (lambda: contact(coefficient=-1), "coefficient is -1"),
    (lambda: contact(normal=[0, 0]), "direction"),
    (lambda: contact(node=[1]), r"node has 1: nodes count from 0 below 1"),
    (lambda: contact(node=[-1]), r"node\[0\] is -1"),
    (lambda: contact(node=[0, 0]), "parallel"),
    (lambda: contact(node=[0, 0, 0]), "3 conditions"),
    (lambda: contact(node=[0.5]), "lists the node of each condition"),
    (lambda: contact(unknowns=3), "unknowns is 3"),
    (lambda: contact(unknowns=[1]), "together 2"),
    (lambda: contact(unknowns=[2.0]), "together 2"),
    (lambda: contact(unknowns=[1, 1], normal=[0, 1]), "direction"),
    (lambda: contact(unknowns=1, bound=1), "no tangent"),
    (lambda: contact().solve("newtno"), "did you mean 'newton'"),
    (lambda: contact().solve("uzawa", step=-1), "step is -1"),
    (lambda: contact().solve("newton", step=1), "leave it out"),
    (lambda: contact().solve("interior-point", start=([0, 0], [[0, 0]])), "leave it out"),
    (lambda: contact().solve("newton", start=([0], [[0, 0]])), r"displacement has the shape \(1,\)"),
    (lambda: contact().solve("newton", start=3), "start is no pair"),
    (lambda: contact().kkt([0, 0], [0, 0]), r"multipliers has the shape \(2,\)"),
    (lambda: contact(stiffness=numpy.diag([1.0, 0.0])).solve(), "nothing stops"),
    (lambda: contact(stiffness=numpy.diag([1.0, 0.0])).solve("uzawa"), "positive definite"),
    (lambda: blocks.ContactProblem(numpy.eye(4), [1] * 4, 0).contraction(contact().solve()), "another problem"),
    # random fields
    (lambda: kl("exponentil"), "did you mean 'exponential'"),
    (lambda: kl(correlation=0), "correlation length is 0"),
    (lambda: kl(correlation=[1, 2]), r"correlation has the shape \(2,\)"),
    (lambda: kl(size=-1), "-1; it must be positive"),
    (lambda: kl(size=NAN), "size is nan"),
    (lambda: kl(size=[1, 2, 3]), "two sides of a rectangle"),
    (lambda: kl(modes=0), "modes is 0"),
    (lambda: kl(modes=20000), "take 10000 or fewer"),
    (lambda: kl(modes=2, captured=0.5), "give one of both"),
    (lambda: kl(captured=1), "above 0 and below 1"),
    (lambda: kl("matern"), "takes one from 0.5 to 10"),
    (lambda: kl("matern", smoothness=99, modes=2), "from 0.5 to 10"),
    (lambda: kl("gaussian", smoothness=2, modes=2), "the others none"),
    (lambda: kl("gaussian", correlation=1e-4), "take at least 0.0039"),
    (lambda: kl().modes(1.5), r"outside of \[0, 1.0\]"),
    (lambda: kl().modes(NAN), "points is nan"),
    (lambda: kl(size=[1, 1]).modes([0.5]), "last axis has x and y"),
    # multiscale bases
    (lambda: blocks.cell_basis(numpy.ones((2, 2)), "oscilatory"), "did you mean 'oscillatory'"),
    (lambda: blocks.cell_basis(numpy.ones(4)), r"young has the shape \(4,\)"),
    (lambda: blocks.cell_basis(numpy.ones((0, 2))), "0 by 2 fine cells"),
    (lambda: blocks.cell_basis([[1, 0], [1, 1]]), r"cell \(0, 1\)"),
    (lambda: blocks.cell_basis([[1, NAN]]), r"young\[0\]\[1\] is nan"),
    (lambda: blocks.cell_basis([[1, "a"]]), "no array of real numbers"),
    (lambda: blocks.cell_basis([[1j]]), "no array of real numbers"),
    (lambda: blocks.cell_basis([[1]], poisson=0.5), "between -1 and 1/2"),
    (lambda: blocks.cell_basis(numpy.ones((2, 2)), poisson=[0.1, 0.2]), r"poisson has the shape \(2,\)"),
    (lambda: blocks.cell_basis([[1]], size=(0, 1)), "must be positive"),
    (lambda: blocks.cell_basis([[1]], "coupled", layers=1), "the others none"),
    (lambda: blocks.cell_basis(numpy.ones((4, 4)), "oversampled", layers=2), "2 of them around"),
    (lambda: blocks.cell_basis(numpy.ones((4, 4)), "oversampled"), "takes 1 or more"),
    (lambda: blocks.cell_basis([[1]], plane="stres"), "did you mean 'stress'"),
])
def test_what_is_wrong_is_named_with_a_remedy(make, told):
    with pytest.raises(steklov.BlockError, match=told) as caught:
        make()
    assert isinstance(caught.value, (steklov.SteklovError, ValueError)) and len(str(caught.value)) > 20


@pytest.mark.parametrize("kind", ["q1", "linear", "coupled", "oscillatory", "periodic"])
@pytest.mark.parametrize("shape", [(1, 1), (1, 3), (3, 1), (2, 2)])
def test_the_smallest_cells_have_bases(kind, shape):
    basis = blocks.cell_basis(numpy.ones(shape), kind)
    assert abs(basis.values.sum(axis=3) - numpy.eye(2)).max() < 1e-13


def test_extreme_numbers_are_answered_or_refused():
    tiny = kl(correlation=1e-300)
    assert tiny.eigenvalues.max() < 1e-299
    for make in (lambda: kl(correlation=1e300), lambda: kl(size=[1e-200, 1e200]), lambda: kl("gaussian", correlation=1e9, modes=5)):
        try:
            assert numpy.isfinite(make().eigenvalues).all()
        except steklov.BlockError as error:
            assert len(str(error)) > 20
    for scale in (1e-90, 1e90):
        polygon = blocks.Polygon(numpy.array(SQUARE[0]) * scale, SQUARE[1])
        S = blocks.Operators(blocks.Mesh.uniform(polygon, 4, 2), 1.0, 0.3).S
        assert numpy.allclose(S, blocks.Operators(block(4, 2), 1.0, 0.3).S, rtol=1e-6, atol=1e-9)
