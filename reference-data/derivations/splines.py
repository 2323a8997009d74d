"""Splines on a line, and what the one-dimensional scripts share: shape functions, Gauss points, dense solves."""

from functools import cache
from math import cos, pi


def open_knots(degree, spans, left=0.0, right=1.0):
    """Equal spans between repeated knots."""
    inner = [left + (right - left) * i / spans for i in range(spans + 1)]
    return [left] * degree + inner + [right] * degree


def uniform_knots(degree, spans, left, h):
    """Equal spans that go on beyond both ends."""
    return [left + h * i for i in range(-degree, spans + degree + 1)]


def shape_functions(knots, degree, x):
    """Index of the first function that is not zero at x, values and derivatives (de Boor)."""
    last = len(knots) - degree - 2
    span = degree
    while span < last and x >= knots[span + 1]:
        span += 1
    values, lower = [1.0], [1.0]
    for q in range(1, degree + 1):
        lower = values
        saved, values = 0.0, []
        for r in range(q):
            left, right = knots[span + 1 - q + r], knots[span + 1 + r]
            part = lower[r] / (right - left)
            values.append(saved + (right - x) * part)
            saved = (x - left) * part
        values.append(saved)
    slopes = [0.0] * (degree + 1)
    for r in range(degree):
        part = degree * lower[r] / (knots[span + 1 + r] - knots[span + 1 - degree + r])
        slopes[r] -= part
        slopes[r + 1] += part
    return span - degree, values, slopes


def mean_functions(knots, degree, x, half_width):
    """The same for means of values and derivatives over an interval, which ends at the ends of the knots."""
    half_width = min(half_width, x - knots[degree], knots[-degree - 1] - x)
    left, right = x - half_width, x + half_width
    cuts = [left, *(k for k in sorted(set(knots)) if left < k < right), right]
    means = {}

    def add(at, weight, slopes_too=False):
        first, values, _ = shape_functions(knots, degree, at)
        for a, value in enumerate(values):
            mean = means.setdefault(first + a, [0.0, 0.0])
            mean[1 if slopes_too else 0] += weight * value

    for low, high in zip(cuts, cuts[1:]):
        for at, weight in gauss(degree // 2 + 1):
            add(low + (high - low) * at, weight * (high - low) / (right - left))
    add(right, 1 / (right - left), True)
    add(left, -1 / (right - left), True)
    first = min(means)
    both = [means.get(i, [0.0, 0.0]) for i in range(first, max(means) + 1)]
    return first, [v for v, _ in both], [s for _, s in both]


def greville(knots, degree):
    return [sum(knots[i + 1 : i + degree + 1]) / degree for i in range(len(knots) - degree - 1)]


@cache
def gauss(n):
    """Points and weights on (0, 1), by Newton's method on Legendre's polynomial."""
    rule = []
    for i in range(n):
        x = cos(pi * (i + 0.75) / (n + 0.5))
        for _ in range(50):
            p, before = 1.0, 0.0
            for k in range(1, n + 1):
                p, before = ((2 * k - 1) * x * p - (k - 1) * before) / k, p
            slope = n * (x * p - before) / (x * x - 1)
            x -= p / slope
        rule.append((0.5 - 0.5 * x, 1 / ((1 - x * x) * slope * slope)))
    return rule


def solve(matrix, right):
    """Gauss's elimination with pivots."""
    n = len(right)
    rows = [list(row) + [b] for row, b in zip(matrix, right)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            if factor:
                for j in range(k, n + 1):
                    rows[i][j] -= factor * rows[k][j]
    x = [0.0] * n
    for k in reversed(range(n)):
        x[k] = (rows[k][n] - sum(rows[k][j] * x[j] for j in range(k + 1, n))) / rows[k][k]
    return x


def matrices(knots, degree, points):
    """Consistent mass, row sums and stiffness of unit density and modulus, from (position, length) of points."""
    n = len(knots) - degree - 1
    mass, stiffness = ([[0.0] * n for _ in range(n)] for _ in range(2))
    for x, volume in points:
        first, values, slopes = shape_functions(knots, degree, x)
        for a in range(degree + 1):
            for b in range(degree + 1):
                mass[first + a][first + b] += volume * values[a] * values[b]
                stiffness[first + a][first + b] += volume * slopes[a] * slopes[b]
    return mass, [sum(row) for row in mass], stiffness


def points_in_spans(spans, left, h, count):
    """Gauss points in equal spans, with their parts of the length."""
    return [(left + h * (i + x), h * w) for i in range(spans) for x, w in gauss(count)]
