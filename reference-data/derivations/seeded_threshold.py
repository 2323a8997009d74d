"""Surface energy of a crack that is seeded by the bound d = 1, in one dimension on splines: AT1 (unit 3/8, m = 1) and
PF-CZM (unit 1/pi, m = 2).

```text
minimise  unit ∫ [(m d + (1 − m) d²)/b + b d'²] dx   for 0 ≤ d ≤ 1,  b = 2 l0,  d = 1 for the functions that do not
vanish at x = 0 or 0.501 spans beside it
```

Sets of values at the bound are found one after the other: those that a solve would make negative join, those
that the residual would raise leave. The energy is Gc for spans of no length.
"""

from math import pi

from splines import gauss, open_knots, shape_functions, solve


def energy(degree, spans_of_l0, place, unit, m):
    """Surface energy over Gc for l0 = 1; the crack lies `place` spans beyond a knot."""
    h, b = 1.0 / spans_of_l0, 2.0
    spans = 24 * spans_of_l0
    knots = open_knots(degree, spans, 0.0, spans * h)
    n = spans + degree
    matrix, load = [[0.0] * n for _ in range(n)], [0.0] * n
    for span in range(spans):
        for point, weight in gauss(degree + 1):
            first, values, slopes = shape_functions(knots, degree, (span + point) * h)
            for i in range(degree + 1):
                load[first + i] += unit * m / b * weight * h * values[i]
                for j in range(degree + 1):
                    local = (1 - m) / b * values[i] * values[j]
                    matrix[first + i][first + j] += 2 * unit * weight * h * (b * slopes[i] * slopes[j] + local)
    broken = set()
    for beside in (-0.501, 0.0, 0.501):
        first, values, _ = shape_functions(knots, degree, (spans // 2 + place + beside) * h)
        broken |= {first + i for i in range(degree + 1) if values[i] > 1e-9}
    d = [1.0 if i in broken else 0.0 for i in range(n)]
    image = lambda: [sum(matrix[i][j] * d[j] for j in range(n)) for i in range(n)]
    while True:
        residual = [r + l for r, l in zip(image(), load)]
        free = [i for i in range(n) if i not in broken and (d[i] > 0 or residual[i] < -1e-14)]
        change = solve([[matrix[i][j] for j in free] for i in free], [-residual[i] for i in free])
        for i, step in zip(free, change):
            d[i] = max(d[i] + step, 0.0)
        if max(abs(step) for step in change) < 1e-13:
            return sum(l * x for l, x in zip(load, d)) + 0.5 * sum(x * y for x, y in zip(d, image()))


if __name__ == "__main__":
    for model, unit, m in (("AT1", 0.375, 1), ("PF-CZM", 1 / pi, 2)):
        for degree in (2, 3):
            for place in (0.0, 0.5):
                values = [energy(degree, n, place, unit, m) for n in (2, 4)]
                print(f"{model}, p = {degree}, {place} spans beyond a knot:", *(f"{v:.7f}" for v in values))
