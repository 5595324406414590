"""The stabilised multipliers of --save stabilisation: their forms, equations and conditions, from the file alone."""

import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
last = sorted(file["steps"])[-1]
at = file["stabilisation"]
assert file[f"steps/{last}/stabilisation"] == at
forms = at["forms"]


def labelled(name, item):
    if isinstance(item, h5py.Dataset):
        for key in ("unit", "meaning", "axes"):
            assert len(item.attrs[key]) > 0, (name, key)


at.visititems(labelled)


def dense(name):
    group = forms[name]
    indptr, matrix = group["indptr"][()], np.zeros(group["shape"][()])
    rows = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    matrix[rows, group["indices"][()]] = group["data"][()]
    return matrix


def close(a, b, scale, what):
    worst = np.abs(a - b).max() / scale
    assert worst <= 1e-12, (what, worst)
    return worst


gamma, critical = at["gamma"][0], at["critical_gamma"][0]
assert 0 < gamma < critical
S, f, u = at["S"][()], at["f"][()], at["displacement"][()]
multipliers, weight = at["multipliers"][()], at["space/weight"][()]
T = [forms[f"trace_{k}"][()] for k in "nt"]
M = [forms[f"values_{k}"][()] for k in "nt"]
tau = [at[f"tau_{k}"][()] for k in "nt"]
C, D = ([forms[f"{name}_gamma_{k}"][()] for k in "nt"] for name in "CD")
B = forms["B_gamma"][()]
worst = close(B, sum(t.T @ t for t in T), np.abs(B).max(), "B")
for k in range(2):
    worst = max(worst, close(C[k], M[k].T @ T[k], np.abs(C[k]).max(), "C"))
    worst = max(worst, close(D[k], M[k].T @ M[k], np.abs(D[k]).max(), "D"))

# (S - γ B) u + Σ Eᵀ λ = f + γ Σ Tᵀ τ on what is not held
E = [dense(f"pairing_{name}") - gamma * C[k] for k, name in enumerate("nt")]
held = at["held"][()]
assert np.array_equal(u[held], at["held_values"][()])
free = np.setdiff1d(np.arange(len(u)), held)
residual = (S - gamma * B) @ u - f
scale = np.abs(S) @ np.abs(u) + np.abs(f)
for k in range(2):
    residual += E[k].T @ multipliers[:, k] - gamma * T[k].T @ tau[k]
    scale += np.abs(E[k]).T @ np.abs(multipliers[:, k])
balance = np.abs(residual[free]).max() / scale.max()
assert balance <= 1e-12, balance

# S - γ B is positive below the critical value, but for motions that nothing resists, and not above it (known to 1 %)
inner = np.ix_(free, free)
loose = int((np.linalg.eigvalsh(S[inner]) < 1e-9 * np.abs(S).max()).sum())
least = lambda part: np.linalg.eigvalsh((S - part * critical * B)[inner])
below, above = least(0.99), least(1.01)
assert loose <= 3 and (below > 1e-12 * below[-1]).sum() == len(free) - loose, below[: loose + 1]
assert above[0] < -1e-12 * above[-1], above[0]

# λ_n >= 0, r_n <= ∫ g μ, one of them in full; |λ_t| <= F + μ λ_n, and less only where nothing slips
r = [E[k] @ u - gamma * (D[k] @ multipliers[:, k] + M[k].T @ tau[k]) for k in range(2)]
pressure, shear = multipliers.T
opening, slip = at["gap"][()] - r[0] / weight, r[1] / weight
bound = at["bound"][()] + at["coefficient"][()] * pressure
length, stress = np.abs(u).max() + np.abs(at["gap"][()]).max(), np.abs(multipliers).max()
assert pressure.min() >= -1e-10 * stress and opening.min() >= -1e-10 * length
work = np.abs(pressure * opening).max() / (stress * length)
assert work <= 1e-10, work
assert (np.abs(shear) - bound).max() <= 1e-10 * stress
sticks = np.abs(shear) < bound - 1e-9 * stress
assert np.abs(slip[sticks]).max(initial=0) <= 1e-10 * length
assert (slip * shear).min() >= -1e-10 * stress * length
assert (pressure > 1e-9 * stress).any()
print(f"forms {worst:.1e} equilibrium {balance:.1e} complementarity {work:.1e}")
