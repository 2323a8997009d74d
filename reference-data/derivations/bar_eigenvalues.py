"""Eigenvalues of a bar of splines: errors of its lowest frequencies, and critical steps where a span is cut.

Unit length, modulus and density. Eigenvalues of `K x = λ M x` are counted by the signs of the pivots of
`K − λ M` (Sylvester) and found by bisection; nothing is taken from the solver.
"""

from math import pi, sqrt

from splines import gauss, matrices, open_knots, points_in_spans


def count_below(k, m, value, degree):
    """Eigenvalues below a value: negative pivots of K − value M, which have `degree` bands on either side."""
    n = len(k)
    rows = [[k[i][j] - value * m[i][j] for j in range(n)] for i in range(n)]
    count = 0
    for i in range(n):
        pivot = rows[i][i]
        count += pivot < 0
        for a in range(i + 1, min(n, i + degree + 1)):
            factor = rows[a][i] / pivot
            for b in range(i + 1, min(n, i + degree + 1)):
                rows[a][b] -= factor * rows[i][b]
    return count


def eigenvalue(k, m, number, degree, low, high):
    """The eigenvalue of that number, from 1, which lies between two values."""
    while high - low > 4e-16 * high:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        low, high = (low, middle) if count_below(k, m, middle, degree) >= number else (middle, high)
    return 0.5 * (low + high)


def diagonal(entries):
    return [[entry if i == j else 0.0 for j in range(len(entries))] for i, entry in enumerate(entries)]


def held(matrix, first, last):
    """Without the first and the last function, where those ends are held."""
    keep = range(1 if first else 0, len(matrix) - (1 if last else 0))
    return [[matrix[i][j] for j in keep] for i in keep]


def frequency_errors(degree, spans, lumped):
    knots = open_knots(degree, spans)
    mass, sums, stiffness = matrices(knots, degree, points_in_spans(spans, 0.0, 1.0 / spans, degree + 1))
    k, m = held(stiffness, True, True), held(diagonal(sums) if lumped else mass, True, True)
    exact = [(n * pi) ** 2 for n in (1, 2, 3)]
    found = [eigenvalue(k, m, n, degree, 0.9 * e, 1.1 * e) for n, e in zip((1, 2, 3), exact)]
    return [sqrt(f / e) - 1 for f, e in zip(found, exact)]


def critical_step(degree, cut, lumped, spans=16):
    """`c dt/h` of a bar of whole spans and a cut part of the next one, held at its left end."""
    knots = open_knots(degree, spans + 1, 0.0, spans + 1.0)
    points = points_in_spans(spans, 0.0, 1.0, degree + 1)
    points += [(spans + cut * x, cut * w) for x, w in gauss(degree + 1)]
    mass, sums, stiffness = matrices(knots, degree, points)
    inside = [i for i, s in enumerate(sums) if s > 0.0][1:]
    pick = lambda matrix: [[matrix[i][j] for j in inside] for i in inside]
    k, m = pick(stiffness), pick(diagonal(sums) if lumped else mass)
    return 2 / sqrt(eigenvalue(k, m, len(inside), degree, 0.1, 1e18))


if __name__ == "__main__":
    for lumped in (False, True):
        for degree in (1, 2, 3):
            errors = " ".join(f"{e:.4e}" for e in frequency_errors(degree, 64, lumped))
            print("lumped" if lumped else "consistent", f"p={degree}, 64 spans, modes 1 to 3: {errors}")
    for lumped in (True, False):
        for degree in (1, 2, 3):
            steps = " ".join(f"{critical_step(degree, cut, lumped):.6g}" for cut in (0.1, 1e-2, 1e-3, 1e-4))
            print("lumped" if lumped else "consistent", f"p={degree}, c dt/h, cut 1e-1 to 1e-4: {steps}")
