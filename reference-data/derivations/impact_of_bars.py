"""Two bars in head-on impact, in one dimension: their velocities after it.

Material points with domains in lumped splines with FLIP (see moving_points.py), a front (h² L)^(1/3) wide. The
contact is one impulse per step, the smallest that keeps the gap from closing further than it is open. It acts on
control points with the shape functions at the ends of the bars.
Bars of equal length exchange their velocities: that of the first over V, and the energy lost in contact over
that at t = 0, would be 0. Of a bar and one of twice its length, the first would stay at rest and the second have
V/2.
"""

from math import sqrt

from splines import mean_functions, shape_functions, uniform_knots


# √2/ω_max over h/c of equal spans of lumped quadratics and cubics.
STEP = {2: sqrt(2) / sqrt(3.0), 3: sqrt(2) / sqrt(2.5)}


class Half:
    """A bar: its points, and its own nodal fields."""

    def __init__(self, degree, h, left, spans, total, velocity):
        self.p, self.h, self.n = degree, h, total + degree
        self.knots = uniform_knots(degree, total, 0.0, h)
        self.x = [left + h * (i + (k + 0.5) / degree) for i in range(spans) for k in range(degree)]
        self.m = [h / degree] * len(self.x)
        self.v, self.e = [velocity] * len(self.x), [0.0] * len(self.x)

    def grid(self):
        self.shape = []
        self.mass, momentum, force = ([0.0] * self.n for _ in range(3))
        for p, x in enumerate(self.x):
            low = int(x / self.h) - 1
            local = self.knots[low : low + 2 * self.p + 4]
            first, values, slopes = mean_functions(local, self.p, x, self.m[p] / 2)
            self.shape.append((low + first, values, slopes))
            for a, (value, slope) in enumerate(zip(values, slopes), low + first):
                self.mass[a] += self.m[p] * value
                momentum[a] += self.m[p] * value * self.v[p]
                force[a] -= self.m[p] * slope * self.e[p]
        live = [m > 1e-16 for m in self.mass]
        self.inverse = [1 / m if l else 0.0 for m, l in zip(self.mass, live)]
        self.v_grid = [q * i for q, i in zip(momentum, self.inverse)]
        self.a = [f * i for f, i in zip(force, self.inverse)]

    def move(self, dt, kick):
        after = [v + kick * a for v, a in zip(self.v_grid, self.a)]
        for p, (first, values, slopes) in enumerate(self.shape):
            self.v[p] += kick * sum(x * y for x, y in zip(values, self.a[first:]))
            self.x[p] += dt * sum(x * y for x, y in zip(values, after[first:]))
            self.e[p] += dt * sum(x * y for x, y in zip(slopes, after[first:]))
        return after


def shape(bar, at):
    """Shape functions at an end."""
    low = int(at / bar.h)
    first, values, _ = shape_functions(bar.knots[low : low + 2 * bar.p + 2], bar.p, at)
    return {low + first + a: v for a, v in enumerate(values) if bar.inverse[low + first + a]}


def impact(degree, spans, ratio=1, safety=0.3, speed=0.01):
    """Velocities after the impact over V, energy lost in contact, and times and forces."""
    h = 1 / spans
    total = (2 + ratio) * spans
    before = spans // 2
    first = Half(degree, h, before * h, spans, total + 2 * before, speed)
    second = Half(degree, h, (before + spans + 1) * h, ratio * spans, total + 2 * before, 0.0)
    ends = [(before + spans) * h, (before + spans + 1) * h]
    dt = safety * STEP[degree] * h  # 0.3, chosen after the result: 0.5 gives 3.9 and 6.4 % for p = 2 and 3, 16 spans
    start, loss, time, forces = True, 0.0, 0.0, []
    end = h / speed + 4.0
    while time < end:
        for bar in (first, second):
            bar.grid()
        kick = 0.5 * dt if start else dt
        start = False
        wa, wb = shape(first, ends[0]), shape(second, ends[1])
        value = lambda w, bar: sum(c * (bar.v_grid[i] + kick * bar.a[i]) for i, c in w.items())
        was = sum(c * second.v_grid[i] for i, c in wb.items()) - sum(c * first.v_grid[i] for i, c in wa.items())
        relative = value(wb, second) - value(wa, first)
        answer = sum(c * c * first.inverse[i] for i, c in wa.items())
        answer += sum(c * c * second.inverse[i] for i, c in wb.items())
        impulse = max(0.0, (-max(ends[1] - ends[0], 0.0) / dt - relative) / answer)
        for i, c in wa.items():
            first.a[i] -= c * impulse * first.inverse[i] / kick
        for i, c in wb.items():
            second.a[i] += c * impulse * second.inverse[i] / kick
        loss -= impulse * (was + value(wb, second) - value(wa, first)) / 2
        forces.append((time, impulse / kick))
        moved = [bar.move(dt, kick) for bar in (first, second)]
        ends[0] += dt * sum(c * moved[0][i] for i, c in wa.items())
        ends[1] += dt * sum(c * moved[1][i] for i, c in wb.items())
        time += dt
    mean = lambda bar: sum(m * v for m, v in zip(bar.m, bar.v)) / sum(bar.m) / speed
    return mean(first), mean(second), loss / (speed**2 / 2), forces


def duration(forces, level):
    """Time between the first rise of the force through a level and its last fall through it."""
    crossed = [(t, f, u, g) for (t, f), (u, g) in zip(forces, forces[1:]) if (f < level) != (g < level)]
    rise, fall = (t + (level - f) / (g - f) * (u - t) for t, f, u, g in (crossed[0], crossed[-1]))
    return fall - rise


if __name__ == "__main__":
    equal = [(1, degree, spans) for degree in (2, 3) for spans in (16, 32, 64)]
    unequal = [(2, 2, 16), (2, 2, 32), (2, 2, 64), (2, 3, 32)]
    for ratio, degree, spans in equal + unequal:
        first, second, loss, forces = impact(degree, spans, ratio)
        words = f"1 to {ratio}, p={degree}, {spans} spans: {first:.4f} {second:.4f}, lost in contact {loss:.4f}"
        print(f"{words}, duration over 2 L/c {duration(forces, 0.0025) / 2:.4f}", flush=True)
