"""Checks a result file of `steklov solve SCENE --save all` from the file alone: python3 check_result.py RESULT.vtkhdf

It needs h5py and numpy. For every formula that applies it prints a line: what, formula, worst relative difference over all
steps. Exit status: 0 all hold, 1 one does not, 2 the file has nothing of it. docs/result-file.md tells what the paths mean.
"""

import json
import sys

import h5py
import numpy as np

TOLERANCE = 1e-12
BLOCK = 256  # columns or rows that are read or multiplied at once

worst = {}  # (what, formula): (difference, tolerance)
left = {}  # what: why it is not checked


def report(what, formula, difference, tolerance=TOLERANCE):
    """Keeps the worst difference of a formula beside its tolerance; a number that is not finite is the worst."""
    difference = float(difference) if np.isfinite(difference) else np.inf
    before, allowed = worst.get((what, formula), (-1.0, 1.0))
    if difference / tolerance > before / allowed:
        worst[what, formula] = (difference, tolerance)


def rounding(size, value):
    """The tolerance of a product whose terms cancel: their sizes summed are so many times the largest value. It is larger than
    that of all others only where that is more than 1e3, as where stiff parts of a body move as rigid ones."""
    return max(TOLERANCE, 4 * np.finfo(float).eps * size / value)


def relative(a, b, scale=None):
    """max |a - b| / scale, by default that of b."""
    a, b = np.asarray(a), np.asarray(b)
    if a.shape != b.shape:
        return np.inf
    if a.size == 0:
        return 0.0
    scale = np.abs(b).max() if scale is None else scale
    difference = np.abs(a - b).max()
    return difference / scale if scale > 0 else (0.0 if difference == 0 else np.inf)


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


class Sparse:
    """A matrix in compressed rows, as scipy's csr_matrix((data, indices, indptr), shape)."""

    def __init__(self, shape, indptr, indices, data):
        self.shape, self.indptr, self.indices, self.data = tuple(shape), indptr, indices, data
        self.rows = np.repeat(np.arange(self.shape[0]), np.diff(indptr))

    @staticmethod
    def read(group):
        return Sparse(*(group[name][()] for name in ("shape", "indptr", "indices", "data")))

    def transposed(self):
        order = np.argsort(self.indices, kind="stable")
        indptr = np.concatenate([[0], np.cumsum(np.bincount(self.indices, minlength=self.shape[1]))])
        return Sparse(self.shape[::-1], indptr, self.rows[order], self.data[order])

    def times(self, x):
        """A x, of a vector or of columns."""
        product = np.zeros((self.shape[0],) + x.shape[1:])
        full = np.flatnonzero(np.diff(self.indptr))
        if len(full):
            terms = self.data.reshape((-1,) + (1,) * (x.ndim - 1)) * x[self.indices]
            product[full] = np.add.reduceat(terms, self.indptr[full], axis=0)
        return product

    def sizes(self):
        """The absolute values of its entries."""
        return Sparse(self.shape, self.indptr, self.indices, np.abs(self.data))

    def columns(self, first, end):
        """Columns first to end, dense."""
        own = (self.indices >= first) & (self.indices < end)
        block = np.zeros((self.shape[0], end - first))
        block[self.rows[own], self.indices[own] - first] = self.data[own]
        return block

    def dense(self):
        return self.columns(0, self.shape[1])


def matrix(item):
    """A stored matrix, dense."""
    return Sparse.read(item).dense() if isinstance(item, h5py.Group) else item[()]


def schur(A, kept, eliminated):
    """A_kk - A_ke A_ee^-1 A_ek."""
    return A[np.ix_(kept, kept)] - A[np.ix_(kept, eliminated)] @ np.linalg.solve(
        A[np.ix_(eliminated, eliminated)], A[np.ix_(eliminated, kept)]
    )


def motions(points, rotation):
    """The rigid motions of points, as vectors of unknowns 2 point + component."""
    x, y = points.T
    one, zero = np.ones_like(x), np.zeros_like(x)
    moves = [(one, zero), (zero, one)] + ([(-y, x)] if rotation else [])
    return [np.column_stack(move).ravel() for move in moves]


# --- boundary elements: V, K, W, M, S


def operators(at):
    V, K, W = (at[name][()] for name in "VKW")
    return V, K, W, matrix(at["M"])


def steklov(V, W, H):
    """S = W + H' V^-1 H, and the sizes of the terms whose rounding it has: |X|' |V| |X| with X = V^-1 H (rounding of V in V X = H).
    V is scaled to a diagonal of 1 first: entries of small elements are far smaller than others, and LU would lose their digits."""
    d = 1 / np.sqrt(np.diag(V))
    X = d[:, None] * np.linalg.solve(d[:, None] * V * d, d[:, None] * H)
    return W + H.T @ X, (np.abs(X).T @ np.abs(V) @ np.abs(X)).max()


def bounded_at_infinity(S):
    """Without a resultant: S_B = S - S 1 (1' S 1)^-1 1' S, 1 the two translations."""
    one = np.tile(np.eye(2), (len(S) // 2, 1))
    return S - S @ one @ np.linalg.solve(one.T @ S @ one, one.T @ S)


def check_operators(file, at, points, curved, alone):
    """V, W symmetric, V positive, W r = 0, (M/2 + K) r = 0 of rigid motions r, S = W + (M/2 + K)' V^-1 (M/2 + K)."""
    V, K, W, M = operators(at)
    H = M / 2 + K
    check_layers(V, W)
    one = motions(np.zeros((len(W) // 2, 2)), False)
    bounded = max(np.abs(H @ r).max() for r in one) < 1e-3 * np.abs(H).max()
    rigid = one if curved or points is None else motions(points, True)
    kernel("W r = 0, r rigid", W, rigid)
    if bounded:
        kernel("(M/2 + K) r = 0, r rigid", H, rigid)
    if "S" not in at:
        return
    S = at["S"][()]
    report("S", "S = S'", relative(S, S.T))
    radiation = (summary(file).get("exterior") or {}).get("radiation")
    if bounded and radiation and alone:
        left["S of a body in a medium on its mesh"] = "the medium is in it, whose operators are not stored"
        return
    made, size = steklov(V, W, H)
    tolerance = rounding(size, np.abs(S).max())
    if not bounded and radiation == "bounded":
        made = bounded_at_infinity(made)
        report("S", "S = S_D - S_D 1 (1' S_D 1)^-1 1' S_D, S_D = W + (M/2+K)' V^-1 (M/2+K)", relative(S, made), tolerance)
        return
    report("S", "S = W + (M/2 + K)' V^-1 (M/2 + K)", relative(S, made), tolerance)
    if bounded:
        kernel("S r = 0, r rigid", S, rigid)


def check_layers(V, W):
    """V and W are symmetric, V has a Cholesky factor."""
    report("V", "V = V'", relative(V, V.T))
    report("W", "W = W'", relative(W, W.T))
    try:
        L = np.linalg.cholesky(V)
        report("V", "V = L L', so that it is positive", relative(L @ L.T, V))
    except np.linalg.LinAlgError:
        report("V", "V = L L', so that it is positive", np.inf)


def kernel(formula, A, rigid):
    for r in rigid:
        report(formula.split(" r")[0], formula, relative(A @ r, 0 * (A @ r), (np.abs(A) @ np.abs(r)).max()))


def check_matrices(file, step, last):
    """The operators of all bodies of a step."""
    at = step["matrices"]
    bodies = body_groups(at)
    curved = "mesh" in step and "shape" in step["mesh"]
    points = file["solution/points"][()] if last and bodies else None
    first = 0
    for body in bodies:
        nodes = body["W"].shape[0] // 2
        own = None if points is None or "nodes" in body else points[first : first + nodes]
        check_operators(file, body, own, curved, len(bodies) == 1)
        first += nodes
    if "medium" in at:
        check_medium(file, at, last)
    if "A_interface" in at:
        check_interface(at)
    if last:
        check_energy(file, at, bodies)


def body_groups(at):
    """The bodies with boundary elements, in their order."""
    names = sorted((name for name in at if name.startswith("body_")), key=lambda name: int(name[5:]))
    return ([at] if "V" in at else []) + [at[name] for name in names]


def check_medium(file, at, last):
    """The medium around a grid: S = W + (M/2 - K)' V^-1 (M/2 - K); V phi = (K - M/2) (xi - a)."""
    V, K, W, M = operators(at["medium"])
    check_layers(V, W)
    points = file["coupling/points"][()] if last else None
    rigid = motions(np.zeros((len(W) // 2, 2)), False) if points is None else motions(points, True)
    kernel("W r = 0, r rigid", W, rigid)
    kernel("(M/2 + K) r = 0, r rigid", M / 2 + K, rigid)
    transfer = at["transfer"]
    projection, moments = matrix(transfer["projection"]), matrix(transfer["mass"])
    report("B", "B = M Pi: moments of the trace against tractions", relative(moments, M @ projection))
    if not last:
        return
    xi, phi = (file["coupling"][name][()] for name in ("displacement", "traction"))
    xi, phi = (xi - file["coupling/constant"][()]).ravel(), phi.ravel()
    image = (K - M / 2) @ xi
    report("medium", "V phi = (K - M/2) (xi - a)", relative(V @ phi, image, (np.abs(K - M / 2) @ np.abs(xi)).max()))
    forces = W @ xi + (K - M / 2).T @ phi
    report("medium", "S_ext xi = W xi + (K - M/2)' phi", relative(steklov(V, W, M / 2 - K)[0] @ xi, forces))


def check_interface(at):
    """A_interface = K_tt - K_ti K_ii^-1 K_it, t the unknowns of the trace."""
    name = "K_H" if "K_H" in at else "K"
    if at[name]["shape"][0] > 4000:
        left["A_interface"] = "more than 4000 unknowns"
        return
    A, kept = matrix(at[name]), at["trace/unknowns"][()]
    others = np.setdiff1d(np.arange(len(A)), kept)
    report("A_interface", f"Schur complement of {name} on the trace", relative(schur(A, kept, others), at["A_interface"][()]))


# --- energies


def summary(file):
    return json.loads(text(file["summary"][()]))


def mentions(file, *words):
    scene = text(file["scene"][()]) + " ".join(text(line) for line in file["overrides"][()])
    return any(word in scene for word in words)


def check_energy(file, at, bodies):
    """Strain energy: 1/2 u' S u of bodies, 1/2 u' K u of a grid, and 1/2 xi' S_ext xi of the medium around it."""
    told = summary(file)
    if bodies:
        check_energy_of_bodies(file, told, bodies)
    elif "K" in at or "K_H" in at:
        check_energy_of_grid(file, told, at)


def check_energy_of_bodies(file, told, bodies):
    if "nodes" in bodies[0]:
        left["strain energy"] = "the displacement on cuts is not in the solution"
        return
    if mentions(file, "body_force"):
        left["strain energy"] = "a body force adds a particular solution"
        return
    if told.get("exterior"):
        left["strain energy"] = "the displacement has that of the remote stress in it"
        return
    u, first, energies, sizes = file["solution/displacement"][()].ravel(), 0, [], []
    for body in bodies:
        S, own = body["S"][()], u[first : first + len(body["S"])]
        if len(bodies) == 1 and not told["reactions"]:
            # polynomials on curves do not follow the rotation of a body that nothing holds
            rigid = np.column_stack(motions(file["solution/points"][()], True))
            own = own - rigid @ np.linalg.lstsq(rigid, own, rcond=None)[0]
        energies.append(own @ S @ own / 2)
        sizes.append(np.abs(own) @ np.abs(S) @ np.abs(own) / 2)
        first += len(own)
    report("strain energy", "strain_energy = sum of 1/2 u' S u", relative(sum(energies), told["strain_energy"]), rounding(sum(sizes), sum(energies)))
    parts = [body["strain_energy"] for body in told.get("bodies") or []]
    if len(parts) == len(energies):
        report("strain energy", "bodies.strain_energy = 1/2 u' S u", relative(energies, parts), rounding(max(sizes), max(energies)))


def grid_unknowns(file, at):
    """K or K_H, the displacement of its unknowns, which of them are on the boundary, and their rigid motions."""
    name = "K_H" if "K_H" in at else "K"
    stiffness = Sparse.read(at[name])
    if name == "K_H":
        values, points = file["multiscale/vertex_displacement"][()], file["multiscale/vertices"][()]
        if "basis" not in file:
            return None
        C = Sparse.read(file["basis/C"])
        row = row_of_unknown(C)
        values = values.ravel()[row]
    else:
        count = stiffness.shape[0] // 2
        values = file["VTKHDF/PointData/displacement"][:count, :2].ravel()
        points, row = file["VTKHDF/Points"][:count, :2], np.arange(2 * count)
    key = lambda p: tuple(np.round(p / np.abs(points).max(), 9) + 0.0)
    boundary = {key(p) for p in file["solution/points"][()]}
    outer = np.array([key(p) in boundary for p in points])[row // 2]
    return name, stiffness, values, outer, [r[row] for r in motions(points, True)]


def row_of_unknown(C):
    """For every coarse unknown the vertex that it is the displacement of: its row of C has one entry 1 alone."""
    single = np.flatnonzero(np.diff(C.indptr) == 1)
    single = single[C.data[C.indptr[single]] == 1]
    row = np.zeros(C.shape[1], dtype=int)
    row[C.indices[C.indptr[single]]] = single
    return row


def check_energy_of_grid(file, told, at):
    found = grid_unknowns(file, at)
    if found is None:
        left["K_H u = f"] = "needs --save basis too"
        return
    name, stiffness, u, outer, rigid = found
    force = stiffness.times(u)
    sizes = stiffness.sizes().times(np.abs(u))
    for r in rigid:
        size = scale = stiffness.sizes().times(np.abs(r)).max()
        if name == "K_H":  # it is P' K P: fine cells may be far stiffer than coarse ones
            K, P = Sparse.read(file["basis/K"]).sizes(), Sparse.read(file["basis/P"]).sizes()
            size = P.transposed().times(K.times(P.times(np.abs(r)))).max()
        report(name, f"{name} r = 0, r rigid", relative(stiffness.times(r), 0 * r, scale), rounding(size, scale))
    report("equilibrium", f"{name} u = f inside", relative(force[~outer], at["f"][()][~outer], sizes.max()))
    if name == "K_H" and mentions(file, "body_force"):
        left["strain energy"] = "a body force strains coarse cells inside"
        return
    energy, size = u @ force / 2, np.abs(u) @ sizes / 2
    if name == "K_H":  # the energy that is told is that of the fine cells
        fine = Sparse.read(file["basis/K"])
        u = np.abs(file["VTKHDF/PointData/displacement"][: fine.shape[0] // 2, :2].ravel())
        size = u @ fine.sizes().times(u) / 2
    if "medium" in at:
        V, K, W, M = operators(at["medium"])
        xi = (file["coupling/displacement"][()] - file["coupling/constant"][()]).ravel()
        energy += xi @ steklov(V, W, M / 2 - K)[0] @ xi / 2
        formula = f"strain_energy = 1/2 u' {name} u + 1/2 xi' S_ext xi"
    else:
        formula = f"strain_energy = 1/2 u' {name} u"
    report("strain energy", formula, relative(energy, told["strain_energy"]), rounding(size, energy))


# --- the condensed contact problem


def contact_nodes(problem):
    """First unknown, their number, first condition and number of conditions of each node."""
    first, unknowns, conditions = (problem[name][()] for name in ("first", "unknowns", "conditions"))
    return zip(first, unknowns, np.cumsum(conditions) - conditions, conditions)


def check_contact(file, step, last):
    """S v + sum (D_n lambda_n n + D_t lambda_t t) = f, and the conditions of contact and friction."""
    problem, solution = step["contact_problem/problem"], step["contact_problem/solution"]
    S, f, v = matrix(problem["stiffness"]), problem["load"][()], solution["displacement"][()]
    multipliers = solution["multipliers"][()]
    normal, tangent = problem["normal"][()], problem["tangent"][()]
    weight = np.column_stack([problem["normal_weight"][()], problem["tangent_weight"][()]])
    force, size = np.zeros_like(f), np.abs(S) @ np.abs(v) + np.abs(f)
    along = np.zeros((len(multipliers), 2))
    for first, unknowns, condition, count in contact_nodes(problem):
        own = slice(first, first + unknowns)
        for c in range(condition, condition + count):
            directions = np.array([normal[c, :unknowns], tangent[c, :unknowns]])
            force[own] += (weight[c] * multipliers[c]) @ directions
            size[own] += np.abs(weight[c] * multipliers[c]) @ np.abs(directions)
            along[c] = directions @ v[own]
    report("contact problem", "S v + D_n lambda_n n + D_t lambda_t t = f", relative(S @ v + force, f, size.max()))
    report("contact problem", "S = S'", relative(S, S.T))
    along[:, 1] += problem["slip_offset"][()]
    bound = problem["bound"][()] + problem["coefficient"][()] * multipliers[:, 0]
    check_conditions("contact", along, problem["gap"][()], bound, multipliers, weight > 0, np.abs(v).max())
    matrices = step.get("matrices")
    if matrices is not None and "S_contact" in matrices:
        report("contact problem", "S = S_contact", relative(S, matrices["S_contact"][()]))
    if last and matrices is not None and len(body_groups(matrices)) == 1:
        check_condensation(file, step, problem, v)


def check_conditions(what, along, gap, bound, multipliers, has, displacement):
    """lambda_n >= 0, u_n <= g, one of them in full; |lambda_t| <= F, lambda_t with the slip, no slip below F."""
    pressure, shear = multipliers.T
    normal, tangential = has.T
    length, stress = displacement + np.abs(gap).max(), np.abs(multipliers).max()
    opening, slip = gap - along[:, 0], along[:, 1]
    worst_of = lambda values, scale: max(values.max(initial=0), 0) / scale if scale > 0 else 0
    report(what, "lambda_n >= 0", worst_of(-pressure, stress))
    report(what, "u_n <= g", worst_of(-opening[normal], length))
    report(what, "lambda_n (g - u_n) = 0", worst_of(np.abs(pressure * opening)[normal], stress * length))
    if not tangential.any():
        return
    report(what, "|lambda_t| <= F + mu lambda_n", worst_of((np.abs(shear) - bound)[tangential], stress))
    report(what, "lambda_t u_t >= 0", worst_of(-(shear * slip)[tangential], stress * length))
    limit = np.minimum(bound, np.abs(bound[np.isfinite(bound)]).max(initial=0) + 10 * stress)
    idle = (limit - np.abs(shear)) * np.abs(slip)
    report(what, "(F + mu lambda_n - |lambda_t|) u_t = 0", worst_of(np.abs(idle)[tangential], stress * length))


def held_components(file):
    """Displacement unknowns that supports hold: of elements whose traction the scene does not give, those in contact apart."""
    mesh, contact = file["mesh"], set(file["contact/side"][()])
    degree, side, next_ = mesh["degree"][()], mesh["side"][()], mesh["elements"][()][:, 1]
    first = np.concatenate([[0], np.cumsum(degree)])
    element, free = file["solution/traction_element"][()], np.isnan(file["solution/traction_prescribed"][()])
    held = np.zeros(2 * first[-1], dtype=bool)
    for e in np.flatnonzero(~np.isin(side, list(contact))):
        nodes = np.append(np.arange(first[e], first[e + 1]), first[next_[e]])
        for component in range(2):
            if free[element == e, component].all():
                held[2 * nodes + component] = True
    return held


def given_load(file, M):
    """f = M' c, c the Legendre coefficients of the given tractions; none where their Gauss points may not resolve them."""
    element, given = file["solution/traction_element"][()], file["solution/traction_prescribed"][()]
    coefficients = np.zeros(M.shape[0])
    side = file["mesh/side"][()]
    constant = {s: np.ptp(given[side[element] == s], axis=0).max() == 0 for s in set(side)}
    for e, p in enumerate(file["mesh/degree"][()]):
        own = np.flatnonzero(element == e)
        values = np.nan_to_num(given[own])
        legendre = np.polynomial.legendre.legvander(np.polynomial.legendre.leggauss(p)[0], p - 1)
        c = np.linalg.solve(legendre, values)
        resolved = p > 1 and np.abs(c[-1]).max() <= 1e-13 * np.abs(values).max()
        if np.abs(values).max() > 0 and not resolved and not constant[side[e]]:
            return None
        coefficients[2 * own[0] : 2 * own[0] + 2 * p] = c.ravel()
    return M.T @ coefficients


def kept_directions(file, problem):
    """The node of each contact node and the rows that take its displacement to its part of v; a sentence where the file does
    not tell them."""
    points = [tuple(p) for p in file["solution/points"][()]]
    where, n = file["contact/points"][()], file["contact/normal"][()]
    if len(where) != len(problem["gap"]):
        return "the contact table is that of stabilised multipliers"
    if len(set(points)) != len(points):
        return "nodes of two faces lie at one point"
    node_at = {p: k for k, p in enumerate(points)}
    normal, tangent = problem["normal"][()], problem["tangent"][()]
    rows = []
    for _, unknowns, c, _ in contact_nodes(problem):
        t = np.array([-n[c, 1], n[c, 0]])
        frame = np.outer(normal[c, :unknowns], n[c]) + np.outer(tangent[c, :unknowns], t)
        if np.abs(frame @ frame.T - np.eye(unknowns)).max() > 1e-12:
            return "a node has unknowns that its first condition does not tell"
        rows.append((node_at.get(tuple(where[c])), frame))
    if any(node is None for node, _ in rows):
        return "a contact node is no node of the boundary elements"
    return rows


def check_condensation(file, step, problem, v):
    """The condensed problem from S: S_kk - S_ke S_ee^-1 S_ek and f_k - S_ke S_ee^-1 f_e, k of contact nodes, e free; what the held
    unknowns add, at their values, is in f."""
    at = step["matrices"]
    why = (
        "curved sides" if "shape" in file["mesh"]
        else "springs are in it" if mentions(file, "spring")
        else "a medium is in it" if summary(file).get("exterior")
        else None
    )
    rows = kept_directions(file, problem) if why is None else why
    if isinstance(rows, str):
        left["condensed contact problem from S"] = rows
        return
    S, n = at["S"][()], len(at["S"])
    turn, kept = np.eye(n), []
    held = held_components(file)
    for node, frame in rows:
        own = [2 * node, 2 * node + 1]
        if len(frame) == 1:
            other = np.array([-frame[0, 1], frame[0, 0]])
            if held[own].any() and np.abs(frame).max() < 1:
                left["condensed contact problem from S"] = "a support is not along the axes"
                return
            frame = np.vstack([frame, other])
            if np.abs(frame[0, 1]) == 1:  # along y: what is left is x
                held[own] = [False, held[own[0]]]
            else:
                held[own] = [False, held[own[1]]]
            kept.append(own[0])
        else:
            kept += own
            held[own] = False
        turn[np.ix_(own, own)] = frame
    u = turn @ file["solution/displacement"][()].ravel()
    report("contact problem", "v = u on the contact nodes", relative(v, u[kept], np.abs(u).max()))
    S = turn @ S @ turn.T
    eliminated = np.setdiff1d(np.flatnonzero(~held), kept)
    if np.linalg.cond(S[np.ix_(eliminated, eliminated)]) > 1e12:
        left["condensed contact problem from S"] = "the body moves freely without its contact"
        return
    report("contact problem", "S = S_kk - S_ke S_ee^-1 S_ek", relative(schur(S, kept, eliminated), problem["stiffness"][()]))
    f = given_load(file, matrix(at["M"]))
    if f is None or mentions(file, "body_force"):
        left["load of the contact problem from S"] = "loads that M does not give exactly"
        return
    fixed = np.flatnonzero(held)
    f = turn @ f - S[:, fixed] @ u[fixed]
    inner = np.linalg.solve(S[np.ix_(eliminated, eliminated)], f[eliminated])
    made = f[kept] - S[np.ix_(kept, eliminated)] @ inner
    size = (np.abs(S[:, fixed]) @ np.abs(u[fixed])).max(initial=0) + np.abs(f).max()
    report("contact problem", "f = f_k - S_ke S_ee^-1 f_e - held", relative(made, problem["load"][()], size))


# --- stabilised multipliers


def check_stabilisation(at):
    """The forms from traces and values, (S - gamma B) u + E' lambda = f + gamma T' tau, the conditions, the critical gamma."""
    forms, gamma, critical = at["forms"], at["gamma"][0], at["critical_gamma"][0]
    S, f, u, multipliers = (at[name][()] for name in ("S", "f", "displacement", "multipliers"))
    T, M = ([forms[f"{name}_{k}"][()] for k in "nt"] for name in ("trace", "values"))
    tau = [at[f"tau_{k}"][()] for k in "nt"]
    C, D = ([forms[f"{name}_gamma_{k}"][()] for k in "nt"] for name in "CD")
    B = forms["B_gamma"][()]
    report("stabilisation", "B = T_n' T_n + T_t' T_t", relative(sum(t.T @ t for t in T), B))
    for k in range(2):
        report("stabilisation", "C = M' T", relative(M[k].T @ T[k], C[k]))
        report("stabilisation", "D = M' M", relative(M[k].T @ M[k], D[k]))
    E = [matrix(forms[f"pairing_{name}"]) - gamma * C[k] for k, name in enumerate("nt")]
    held = at["held"][()]
    report("stabilisation", "u = held values", relative(u[held], at["held_values"][()], np.abs(u).max()))
    free = np.setdiff1d(np.arange(len(u)), held)
    residual, size = (S - gamma * B) @ u - f, np.abs(S) @ np.abs(u) + np.abs(f)
    for k in range(2):
        residual += E[k].T @ multipliers[:, k] - gamma * T[k].T @ tau[k]
        size += np.abs(E[k]).T @ np.abs(multipliers[:, k])
    report("stabilisation", "(S - gamma B) u + E' lambda = f + gamma T' tau", relative(residual[free], 0 * free, size.max()))
    report("stabilisation", "gamma < critical gamma", max(gamma / critical - 1, 0))
    inner = np.ix_(free, free)
    values = np.linalg.eigvalsh((S - 0.99 * critical * B)[inner])
    report("stabilisation", "S - 0.99 critical B >= 0", max(-values[0], 0) / values[-1])
    weight = at["space/weight"][()]
    r = [(E[k] @ u - gamma * (D[k] @ multipliers[:, k] + M[k].T @ tau[k])) / weight for k in range(2)]
    bound = at["bound"][()] + at["coefficient"][()] * multipliers[:, 0]
    has = np.ones((len(weight), 2), dtype=bool)
    check_conditions("stabilised contact", np.column_stack(r), at["gap"][()], bound, multipliers, has, np.abs(u).max())


# --- multiscale bases

CORNER = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])


def check_basis(step, file, last):
    """K = sum E K_0, K_T = R' K_cell R, K_H = sum of factor C_T' K_T C_T, P from R and C, K_H = P' K P."""
    at = step["basis"]
    K, P, C = (Sparse.read(at[name]) for name in "KPC")
    nodes, fine, young, unit = (at[name][()] for name in ("nodes", "fine_cells", "young", "K_0"))
    number = {tuple(point): k for k, point in enumerate(nodes)}
    unknown = lambda cell: [2 * number[tuple(cell + c)] + k for c in CORNER for k in range(2)]
    check_fine_stiffness(K, np.array([unknown(cell) for cell in fine]), young, unit)
    kernel("K_0 r = 0, r rigid", unit, motions(CORNER * at["place"][()][1], True))
    coarse, field = check_cells(at, C, number, {tuple(p): E for p, E in zip(fine, young)}, unit)
    conforming = not text(at["kind"][()]).startswith(("oversampled", "periodic"))
    report("basis", "P = mean of R_T C_T", entries_apart(P, field))
    if "matrices" not in step or "K_H" not in step["matrices"]:
        left["K_H"] = "needs --save matrices too"
        return
    K_H = Sparse.read(step["matrices/K_H"])
    report("basis", "K_H = sum of factor C_T' K_T C_T", entries_apart(K_H, coarse))
    if conforming:
        check_galerkin(K, P, K_H)
    if last:
        U = file["multiscale/vertex_displacement"][()].ravel()[row_of_unknown(C)]
        u = file["VTKHDF/PointData/displacement"][: len(nodes), :2].ravel()
        stored = np.abs(u).max()
        if conforming and not mentions(file, "body_force"):
            report("basis", "u = P U", relative(P.times(U), u, stored))


def entries_apart(A, terms):
    """Largest difference of a sparse matrix and one given as {(row, column): value}, over its largest entry."""
    own = dict(zip(zip(A.rows.tolist(), A.indices.tolist()), A.data.tolist()))
    keys = own.keys() | terms.keys()
    return max(abs(own.get(key, 0) - terms.get(key, 0)) for key in keys) / np.abs(A.data).max()


def check_fine_stiffness(K, unknowns, young, unit):
    """K = sum over the fine cells of young K_0."""
    n = K.shape[1]
    keys = (unknowns[:, :, None] * n + unknowns[:, None, :]).ravel()
    values = (young[:, None, None] * unit).ravel()
    keys, place = np.unique(keys, return_inverse=True)
    values = np.bincount(place.ravel(), weights=values)
    own = K.rows * n + K.indices
    stored = np.isin(keys, own)
    missed = np.abs(values[~stored]).max(initial=0) / np.abs(K.data).max()
    data = np.zeros(len(own))
    known = np.isin(own, keys)
    data[known] = values[np.searchsorted(keys, own[known])]
    report("basis", "K = sum of E K_0", max(relative(data, K.data), missed))


def check_cells(at, C, number, modulus, unit):
    """K_T of every coarse cell; all cells put together to K_H, and R_T C_T to P."""
    R, offset, K_T = (at[name][()] for name in ("R", "offset", "K_T"))
    first, size, pattern, factor = (at[name][()] for name in ("first", "size", "pattern", "factor"))
    corners = at["corners"][()].reshape(-1, 4)
    coarse, sums, count = {}, {}, {}
    for T in range(len(first)):
        m, n = size[T]
        basis = R[offset[pattern[T]] : offset[pattern[T] + 1]]
        stiffness = factor[T] * K_T[8 * pattern[T] : 8 * pattern[T] + 8]
        inner = cell_stiffness(first[T], m, n, modulus, unit)
        terms = (np.abs(basis).T @ np.abs(inner) @ np.abs(basis)).max()
        tolerance = rounding(terms, np.abs(stiffness).max())
        report("basis", "factor K_T = R' K_cell R", relative(basis.T @ inner @ basis, stiffness), tolerance)
        rows = (2 * corners[T][:, None] + np.arange(2)).ravel()
        columns = np.unique(np.concatenate([C.indices[C.indptr[r] : C.indptr[r + 1]] for r in rows]))
        own = np.zeros((8, len(columns)))
        for i, r in enumerate(rows):
            part = slice(C.indptr[r], C.indptr[r + 1])
            own[i, np.searchsorted(columns, C.indices[part])] = C.data[part]
        add(coarse, columns, columns, own.T @ stiffness @ own)
        nodes = [number[(first[T][0] + i, first[T][1] + j)] for j in range(n + 1) for i in range(m + 1)]
        unknowns = np.array([2 * k + c for k in nodes for c in range(2)])
        for k in unknowns.tolist():
            count[k] = count.get(k, 0) + 1
        add(sums, unknowns, columns, basis @ own)
    return coarse, {(k, j): value / count[k] for (k, j), value in sums.items()}


def add(terms, rows, columns, block):
    columns = columns.tolist()
    for i, values in zip(rows.tolist(), block.tolist()):
        for j, value in zip(columns, values):
            terms[i, j] = terms.get((i, j), 0.0) + value


def cell_stiffness(first, m, n, modulus, unit):
    """Stiffness of the m by n fine cells of a coarse one, local node (i, j) is j (m+1) + i."""
    inner = np.zeros((2 * (m + 1) * (n + 1),) * 2)
    for i in range(m):
        for j in range(n):
            own = [2 * ((j + c[1]) * (m + 1) + i + c[0]) + k for c in CORNER for k in range(2)]
            inner[np.ix_(own, own)] += modulus[(first[0] + i, first[1] + j)] * unit
    return inner


def check_galerkin(K, P, K_H):
    """K_H = P' K P, some columns at a time."""
    transposed, scale, apart = P.transposed(), np.abs(K_H.data).max(), 0.0
    for first in range(0, K_H.shape[1], BLOCK):
        end = min(first + BLOCK, K_H.shape[1])
        made = transposed.times(K.times(P.columns(first, end)))
        apart = max(apart, relative(made, K_H.columns(first, end), scale))
    report("basis", "K_H = P' K P", apart, rounding(np.abs(K.data).max(), scale))


# --- random input


def check_stochastic(at):
    """Moments, masses of stochastic cells, eigenpairs."""
    if "outcomes" in at:
        check_outcomes(at)
    if "cells" in at:
        check_stochastic_cells(at)
    for k in at.get("eigenpairs", ()):
        pair = at["eigenpairs"][k]
        if "left_out" in pair:
            left[f"eigenpairs {k}"] = text(pair["left_out"][()])
            continue
        w, modes, eigenvalues = pair["weights"][()], pair["modes"][()], pair["eigenvalues"][()]
        report("eigenpairs", "eigenvalues = those of /stochastic/fields", relative(eigenvalues, at["fields"][k]["eigenvalues"][()]))
        captured = at["fields"][k]["captured"][0]
        if "cells" in pair:  # means over cells are not orthogonal
            report("eigenpairs", "captured = sum w phi_m^2 / |D|", relative((w @ modes**2).sum() / w.sum(), captured, 1))
            continue
        report("eigenpairs", "sum w phi_m phi_n = lambda_m delta_mn", relative((modes * w[:, None]).T @ modes, np.diag(eigenvalues)))
        report("eigenpairs", "captured = sum lambda_m / |D|", relative(eigenvalues.sum() / w.sum(), captured, 1))


def moments(table, weights):
    """Mean and variance of the rows of a table with these weights, read in pieces."""
    mean, scale = np.zeros(table.shape[1]), 0.0
    pieces = [slice(k, k + BLOCK) for k in range(0, len(table), BLOCK)]
    for own in pieces:
        values = table[own]
        mean += weights[own] @ values
        scale = max(scale, np.abs(values).max())
    return mean, sum(weights[own] @ (table[own] - mean) ** 2 for own in pieces), scale or 1.0


def check_outcomes(at):
    """Means and variances are those of the outcomes with their weights."""
    weights = at["weights"][()]
    report("outcomes", "sum of weights = 1", relative(weights.sum(), 1))
    for name in ("displacement", "pressure", "shear"):
        table = at["outcomes"][name]
        if table.size == 0:
            continue
        mean, variance, scale = moments(table, weights)
        report("outcomes", f"mean {name} = sum w x", relative(mean, at[name]["mean"][()], scale))
        report("outcomes", f"variance {name} = sum w (x - mean)^2", relative(variance, at[name]["variance"][()], scale**2))
    if "displacements" in at:
        report("outcomes", "displacements = outcomes/displacement", relative(at["displacements"][()], at["outcomes/displacement"][()]))
    for k in at["quantities"]:
        values, both = at["quantities"][k]["values"][()], at["quantities"][k]["moments"][()]
        scale = np.abs(values).max() or 1.0
        mean = weights @ values
        variance = weights @ (values - both[0]) ** 2
        error = at["quantities"][k].get("variance_error")
        if error is not None and np.ptp(weights) > 0:
            # the variance of polynomials that outcomes correct is no sum over the points
            variance = both[1]
        made = [mean / scale, variance / scale**2]
        report("outcomes", "moments of quantities", relative(made, [both[0] / scale, both[1] / scale**2], 1))


def check_stochastic_cells(at):
    """M_jk = sum w theta_j theta_k, (M_E)_jk = sum w E theta_j theta_k, D = diag M, theta Lagrange polynomials of the nodes."""
    first = 0
    for name in sorted(at["cells"]):
        cell = at["cells"][name]
        nodes, D = cell["basis/points"][()], cell["basis/weights"][()]
        own = slice(first, first + len(D))
        first += len(D)
        report("stochastic cells", "nodes, D = points, weights of outcomes", max(relative(nodes, at["points"][own]), relative(D, at["weights"][own])))
        theta, w = np.ones((1, 1)), np.ones(1)
        for d in range(nodes.shape[1]):
            axis = cell[f"axis_{d}"]
            x, v, values = (axis[part][()] for part in ("points", "weights", "values"))
            report("stochastic cells", "theta = Lagrange polynomials", relative(values, lagrange(np.unique(nodes[:, d]), x)))
            theta, w = np.kron(theta, values), np.kron(w, v)
        if "left_out" in cell:
            left["masses of stochastic cells"] = text(cell["left_out"][()])
            continue
        mass = cell["mass"][()]
        report("stochastic cells", "M = sum w theta theta'", relative((theta * w[:, None]).T @ theta, mass))
        report("stochastic cells", "M = diag D", relative(np.diag(D), mass))
        if "M_E" in cell:
            w = w * cell["modulus"][()]
            report("stochastic cells", "M_E = sum w E theta theta'", relative((theta * w[:, None]).T @ theta, cell["M_E"][()]))
    report("stochastic cells", "as many nodes as outcomes", 0 if first == len(at["points"]) else np.inf)


def lagrange(nodes, x):
    """theta_j(x_i) = product over k != j of (x_i - t_k) / (t_j - t_k)."""
    values = np.ones((len(x), len(nodes)))
    for j, t in enumerate(nodes):
        for other in np.delete(nodes, j):
            values[:, j] *= (x - other) / (t - other)
    return values


def main(path):
    with h5py.File(path) as file:
        if "steps" not in file:
            print("no result file of steklov solve")
            return 2
        steps = sorted(file["steps"], key=int)
        for name in steps:
            step, last = file["steps"][name], name == steps[-1]
            if "matrices" in step:
                check_matrices(file, step, last)
            if "contact_problem" in step:
                check_contact(file, step, last)
            if "stabilisation" in step:
                check_stabilisation(step["stabilisation"])
            if "basis" in step:
                check_basis(step, file, last)
        if "stochastic" in file:
            check_stochastic(file["stochastic"])
    if not worst:
        print("nothing to check in this file: solve with --save all")
        return 2
    for (what, formula), (difference, tolerance) in worst.items():
        because = f"  tolerance {tolerance:.0e}: terms that cancel" if tolerance > TOLERANCE else ""
        wrong = "" if difference <= tolerance else "  DOES NOT HOLD"
        print(f"{what:20} {formula:66} {difference:.1e}{because}{wrong}")
    for what, why in left.items():
        print(f"not checked: {what}: {why}")
    (what, formula), (difference, tolerance) = max(worst.items(), key=lambda item: item[1][0] / item[1][1])
    print(f"worst: {difference:.1e} of {what}: {formula}")
    return int(not difference <= tolerance)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
