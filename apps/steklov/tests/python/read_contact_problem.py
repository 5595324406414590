"""The contact problem of --save contact: its equations and conditions, from the file alone."""

import sys

import h5py
import numpy as np

file = h5py.File(sys.argv[1])
at = file["contact_problem/problem"]
solution = file["contact_problem/solution"]
S, f = at["stiffness"][()], at["load"][()]
v, multipliers, status = (solution[name][()] for name in ("displacement", "multipliers", "status"))
assert S.shape == (len(f), len(f)) and v.shape == f.shape and len(multipliers) == len(status) == len(at["gap"])
for name in at:
    for key in ("unit", "meaning", "axes"):
        assert len(at[name].attrs[key]) > 0, (name, key)

# S v + Σ (D_n λ_n n + D_t λ_t t) = f, the rows of each node's conditions in turn
force = np.zeros_like(f)
condition = 0
normal_displacement, slip = np.zeros(len(status)), np.zeros(len(status))
for first, unknowns, conditions in zip(at["first"], at["unknowns"], at["conditions"]):
    for c in range(condition, condition + conditions):
        for i in range(unknowns):
            n, t = at["normal"][c, i], at["tangent"][c, i]
            force[first + i] += at["normal_weight"][c] * multipliers[c, 0] * n
            force[first + i] += at["tangent_weight"][c] * multipliers[c, 1] * t
            normal_displacement[c] += n * v[first + i]
            slip[c] += t * v[first + i]
    condition += conditions
assert condition == len(status)
scale = np.abs(S) @ np.abs(v) + np.abs(f)
assert np.abs(S @ v + force - f).max() <= 1e-12 * scale.max(), np.abs(S @ v + force - f).max()

# λ_n >= 0, g - u_n >= 0, one of them 0; |λ_t| <= F + mu λ_n, and less than that only where nothing slips
pressure, shear = multipliers.T
opening = at["gap"][()] - normal_displacement
slip += at["slip_offset"][()]
bound = at["bound"][()] + at["coefficient"][()] * pressure
has_normal, has_tangent = at["normal_weight"][()] > 0, at["tangent_weight"][()] > 0
length, stress = np.abs(v).max() + np.abs(at["gap"][()]).max(), np.abs(multipliers).max()
assert pressure.min() >= -1e-10 * stress and opening[has_normal].min() >= -1e-10 * length
assert np.abs(pressure * opening)[has_normal].max() <= 1e-10 * stress * length
assert (np.abs(shear) - bound)[has_tangent].max(initial=0) <= 1e-10 * stress
sticks = has_tangent & (np.abs(shear) < bound - 1e-9 * stress)
assert np.abs(slip[sticks]).max(initial=0) <= 1e-10 * length
assert (slip * shear)[has_tangent].min(initial=0) >= -1e-10 * stress * length
assert (pressure > 1e-9 * stress).any()
# the same problem lies under its step, and nothing else was asked for
last = sorted(file["steps"])[-1]
assert file[f"steps/{last}/contact_problem/problem"] == at
assert "matrices" not in file and "matrices" not in file[f"steps/{last}"]
print(f"worst residual {np.abs(S @ v + force - f).max() / scale.max():.1e}")
