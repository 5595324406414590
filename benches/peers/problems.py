"""The two contact references as numbers that every code can use, and what does not depend on the code.

The body is the unit square [-1/2, 1/2]^2 in plane strain; its lower side meets the obstacle
(n = (0, -1), u_n = -u_y, u_t = u_x). The energy is J(u) = 1/2 a(u, u) - L(u) + F * (integral of |u_t| over the lower
side), over the whole of it, also where it is open, because the friction is Tresca's.
"""

from dataclasses import dataclass

import numpy as np

# of the reference energies
LAST_DIGIT = 1e-13


@dataclass(frozen=True)
class Problem:
    """Material, friction bound, gap and loads; `energy` is the reference, `end` the contact zone's half-length."""

    name: str
    young: float
    poisson: float
    friction: float
    held: bool
    energy: float
    end: float

    @property
    def lame(self):
        """The pair lambda, mu."""
        e, nu = self.young, self.poisson
        return e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))

    def error(self, energy):
        """Relative energy error (|J - Jref| / |Jref|)^(1/2), no smaller than the digits of Jref can tell."""
        return float(np.sqrt(max(abs(energy - self.energy), LAST_DIGIT) / abs(self.energy)))

    def gap(self, x):
        """Distance to the obstacle along n; negative for an overlap."""
        return np.abs(x) / 10 - 0.05 if self.held else np.zeros_like(x)

    def side_load(self, x, y):
        """Traction on the vertical sides."""
        bubble = 0 * y if self.held else (y + 0.5) * (0.5 - y)
        return -400 * np.sign(x) * bubble * np.exp(-10 * (y + 0.3) ** 2), 10 * bubble

    def top_load(self, x):
        """Traction on the upper side, along y."""
        return 0 * x if self.held else -500 * (0.5 - x) ** 2 * (0.5 + x) ** 2

    @property
    def kinks(self):
        """Where the data alone make the solution singular: the ends of the held side and the ridge of the wedge."""
        return [(-0.5, 0.5), (0.5, 0.5), (0.0, -0.5)] if self.held else []

    def grid(self, cells, told):
        """Coordinates of the first mesh along x and y; `told` puts lines through the ends of the contact zone."""
        even = np.linspace(-0.5, 0.5, cells + 1)
        if not told:
            return even, even
        a = self.end
        return np.array([-0.5, -a, -a / 2, 0, a / 2, a, 0.5]), even


PROBLEMS = {
    p.name: p
    for p in (
        Problem("block-on-floor", 200.0, 0.3, 0.3, False, -2.9933291930708, 0.42901463),
        Problem("wedge-gap", 1000.0, 0.3, 0.3, True, 0.6471940159869, 0.25999231),
    )
}
