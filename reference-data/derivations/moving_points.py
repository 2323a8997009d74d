"""Material points that cross the spans of a bar: errors of a wave, and what a vibration loses.

`hencky-wave` of the verification (see bar_wave.py) with lumped mass, equally spaced points and steps in
proportion to the spans, shape functions as means over the domains of the points: relative root mean square of the displacement error over the points at t = 0.6 s. The
bar under its own weight of the case `energy/flip-loss`: loss of the transfers per period over the energy of
the vibration. In one dimension, written apart from the solver.
"""

from math import cos, log, pi, sin, sqrt

from bar_eigenvalues import diagonal, eigenvalue, held
from splines import greville, matrices, mean_functions, open_knots

A1, A2 = 0.04, 0.02


def wave(x, t):
    """Displacement, velocity, and body force per mass of the wave with P = ln(F)/F."""
    s, c = sin, cos
    u = A1 * s(pi * x) * s(pi * t) + A2 * s(2 * pi * x) * s(2 * pi * t)
    v = pi * A1 * s(pi * x) * c(pi * t) + 2 * pi * A2 * s(2 * pi * x) * c(2 * pi * t)
    acceleration = -(pi**2) * A1 * s(pi * x) * s(pi * t) - 4 * pi**2 * A2 * s(2 * pi * x) * s(2 * pi * t)
    f = 1 + pi * A1 * c(pi * x) * s(pi * t) + 2 * pi * A2 * c(2 * pi * x) * s(2 * pi * t)
    return u, v, acceleration - (1 - log(f)) / f**2 * acceleration, f


class Bar:
    """Points, and what a step makes of them."""

    def __init__(self, degree, spans, points, transfer, weak=False, finite=True):
        self.degree, self.knots, self.transfer = degree, open_knots(degree, spans), transfer
        self.h, self.n, self.finite, self.weak = 1 / spans, spans + degree, finite, weak
        self.nodes = greville(self.knots, degree)
        self.reference = [x for x, _ in points]
        self.volume = [v for _, v in points]
        self.x = list(self.reference)
        self.v, self.c, self.f = [0.0] * len(points), [0.0] * len(points), [1.0] * len(points)
        self.time, self.start = 0.0, True
        self.find()

    def find(self):
        """Shape functions of the points: on the spans around each, found by division, since spans are equal."""
        self.shape = []
        for x, volume, f in zip(self.x, self.volume, self.f):
            p, last = self.degree, self.n - self.degree - 1
            span = min(int(x / self.h), last)
            low, high = max(span - 1, 0), min(span + 1, last)
            local = self.knots[low : high + 2 * p + 2]
            first, values, slopes = mean_functions(local, p, x, volume / 2 * (f if self.finite else 1.0))
            self.shape.append((low + first, values, slopes))

    def grid(self, t, gravity):
        """Lumped mass, velocity and acceleration of the control points."""
        mass, momentum, force = ([0.0] * self.n for _ in range(3))
        affine = self.transfer in ("apic", "tpic")
        for p, (first, values, slopes) in enumerate(self.shape):
            m = self.volume[p]
            stress = log(self.f[p]) if self.finite else self.f[p] - 1
            if self.weak:
                f = wave(self.reference[p], t)[3]
                stress -= log(f)
                body = m * self.exact_acceleration(p, t)
            elif gravity is None:
                body = m * wave(self.reference[p], t)[2]
            else:
                body = m * gravity
            for a, (value, slope) in enumerate(zip(values, slopes)):
                i = first + a
                mass[i] += m * value
                velocity = self.v[p] + (self.c[p] * (self.nodes[i] - self.x[p]) if affine else 0.0)
                momentum[i] += m * value * velocity
                force[i] += value * body - m * slope * stress
        v = [a / b if b > 1e-16 else 0.0 for a, b in zip(momentum, mass)]
        a = [f / b if b > 1e-16 else 0.0 for f, b in zip(force, mass)]
        v[0] = v[-1] = a[0] = a[-1] = 0.0
        return mass, v, a

    def exact_acceleration(self, p, t):
        x = self.reference[p]
        return -(pi**2) * A1 * sin(pi * x) * sin(pi * t) - 4 * pi**2 * A2 * sin(2 * pi * x) * sin(2 * pi * t)

    def step(self, dt, gravity=None):
        mass, v, a = self.grid(self.time, gravity)
        kick = 0.5 * dt if self.start else dt
        self.start = False
        after = [x + kick * y for x, y in zip(v, a)]
        for p, (first, values, slopes) in enumerate(self.shape):
            found = after[first : first + len(values)]
            if self.transfer == "flip":
                self.v[p] += kick * sum(x * y for x, y in zip(values, a[first:]))
            else:
                self.v[p] = sum(x * y for x, y in zip(values, found))
            if self.transfer == "tpic":
                self.c[p] = sum(x * y for x, y in zip(slopes, found))
            elif self.transfer == "apic":
                arms = [self.nodes[first + k] - self.x[p] for k in range(len(values))]
                d = sum(x * arm * arm for x, arm in zip(values, arms))
                self.c[p] = sum(x * arm * y for x, arm, y in zip(values, arms, found)) / d
            gradient = sum(x * y for x, y in zip(slopes, found))
            self.f[p] *= 1 + dt * gradient if self.finite else 1 + dt * gradient / self.f[p]
            self.x[p] += dt * sum(x * y for x, y in zip(values, found))
        self.time += dt
        self.find()


def equally_spaced(spans, count):
    return [((i + (k + 0.5) / count) / spans, 1 / (spans * count)) for i in range(spans) for k in range(count)]


def critical(degree):
    """√2/ω_max of points at rest, on 16 spans: over the span length."""
    _, sums, k = matrices(open_knots(degree, 16), degree, equally_spaced(16, 8))
    k, m = held(k, True, True), held(diagonal(sums), True, True)
    return sqrt(2 / eigenvalue(k, m, len(k), degree, 1.0, 1e8)) * 16


def wave_error(degree, spans, count, transfer, weak=False):
    bar = Bar(degree, spans, equally_spaced(spans, count), transfer, weak)
    bar.v = [wave(x, 0.0)[1] for x in bar.reference]
    steps = -int(-0.6 // (0.4 * critical(degree) / spans))
    for _ in range(steps):
        bar.step(0.6 / steps)
    error = size = 0.0
    for x, X in zip(bar.x, bar.reference):
        u = wave(X, 0.6)[0]
        error, size = error + (x - X - u) ** 2, size + u * u
    return sqrt(error / size)


def orders(errors):
    return [log(a / b) / log(2) for a, b in zip(errors, errors[1:])]


def fitted_order(errors):
    n = len(errors)
    x = [-i * log(2) for i in range(n)]
    y = [log(e) for e in errors]
    mx, my = sum(x) / n, sum(y) / n
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def loss_per_period(degree, transfer, periods=20, dt=0.0125):
    """Part of its energy that a vibration under its own weight loses per period of 2 s: slope of a fitted line."""
    bar = Bar(degree, 16, equally_spaced(16, 3), transfer, finite=False)
    gravity, missing = 1e-8, []
    for _ in range(int(2 * periods / dt)):
        before = list(bar.v)
        bar.step(dt, gravity)
        elastic = sum(v * (f - 1) ** 2 / 2 for v, f in zip(bar.volume, bar.f))
        kinetic = sum(m * ((a + b) / 2) ** 2 / 2 for m, a, b in zip(bar.volume, before, bar.v))
        work = gravity * sum(m * (x - X) for m, x, X in zip(bar.volume, bar.x, bar.reference))
        missing.append(work - elastic - kinetic)
    n = len(missing)
    middle, mean = (n - 1) / 2, sum(missing) / n
    slope = sum((k - middle) * (m - mean) for k, m in enumerate(missing)) / sum((k - middle) ** 2 for k in range(n))
    return slope * 2 / dt / (gravity**2 / 24)


if __name__ == "__main__":
    cases = [("flip", p, n, False) for p in (1, 2, 3) for n in (2, 4, 8)]
    cases += [(transfer, p, n, False) for transfer in ("apic", "tpic", "pic") for p, n in ((2, 8), (3, 4))]
    for transfer, degree, count, weak in [*cases, ("flip", 1, 4, True)]:
        errors = [wave_error(degree, spans, count, transfer, weak) for spans in (16, 32, 64, 128)]
        found, pairs = (" ".join(f"{n:.3g}" for n in numbers) for numbers in (errors, orders(errors)))
        words = f"{transfer}, p={degree}, {count} points" + (", exact stress as load" if weak else "")
        print(f"{words}: {found}, orders {pairs}, {fitted_order(errors[-3:]):.2f} over the last three", flush=True)
    for degree in (2, 3):
        print(f"flip, p={degree}: {loss_per_period(degree, 'flip'):.5f} of its energy lost per period")
