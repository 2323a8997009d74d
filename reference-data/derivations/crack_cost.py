"""What a crack costs on a mesh: surface energy of a line of broken quadrature points, one dimension across the crack.

Minimises  sum_q w_q [(1 - c)^2/(4 l0) + l0 c'^2 + B_q c^2/(4 l0)]  over splines of degree p on equal spans h, l0 = 1, Gc = 1. B = 4 l0 H/Gc is
`BROKEN` at broken points and 0 elsewhere. A cost counts the first two terms alone, in Gc: 1 in the limit h -> 0. Standard library only.

Columns of `crack-cost.csv`: spans h in l0; rows are quadrature points across the crack. `one_row` is the cheapest point of a span, `one_row_dearest`
the dearest; `one_row_b10`, `_b100`, `_b1000` have B of that value instead (large but finite history). `symmetry_...` are half models whose line of
symmetry is an end of the spline, both sides counted.

AT1: minimises  3/8 sum_q w_q [(1 - c)/b + b c'^2 + B_q c^2/b], b = 2 l0 = 2, over control values between 0 and 1. No control value is negative, so
where c vanishes at a point it does so in the whole span, and a row costs more the larger its B is. `crack-cost-at1.csv` has the cost for three B.
"""

import csv
from math import sqrt
from pathlib import Path

BROKEN = 1e9          # 4 l0 H/Gc of a broken point; 1e7 moves no digit of the table
HALF_LENGTH = 14.0    # of the body, in l0: exp(-14) of the cost lies outside
GAUSS = {
    2: ([-1 / sqrt(3), 1 / sqrt(3)], [1.0, 1.0]),
    3: ([-sqrt(0.6), 0.0, sqrt(0.6)], [5 / 9, 8 / 9, 5 / 9]),
    4: ([-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526],
        [0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538]),
}


def basis(knots, degree, span, x):
    """Values and derivatives of the degree + 1 splines that live in [knots[span], knots[span + 1]], by Cox and de Boor."""
    values = [1.0]
    for k in range(1, degree + 1):
        if k == degree:
            lower = values
        values = [
            (values[r - 1] * (x - knots[span - k + r]) / (knots[span + r] - knots[span - k + r]) if r > 0 else 0.0)
            + (values[r] * (knots[span + r + 1] - x) / (knots[span + r + 1] - knots[span - k + r + 1]) if r < k else 0.0)
            for r in range(k + 1)
        ]
    slopes = [
        degree * ((lower[r - 1] / (knots[span + r] - knots[span - degree + r]) if r > 0 else 0.0)
                  - (lower[r] / (knots[span + r + 1] - knots[span - degree + r + 1]) if r < degree else 0.0))
        for r in range(degree + 1)
    ]
    return values, slopes


def solve(bands, right):
    """Symmetric positive definite, banded: bands[i][k] couples i and i + k."""
    n, width = len(right), len(bands[0])
    a, b = [row[:] for row in bands], right[:]
    for i in range(n):
        for k in range(1, min(width, n - i)):
            factor = a[i][k] / a[i][0]
            for m in range(k, min(width, n - i)):
                a[i + k][m - k] -= factor * a[i][m]
            b[i + k] -= factor * b[i]
    for i in reversed(range(n)):
        b[i] = (b[i] - sum(a[i][k] * b[i + k] for k in range(1, min(width, n - i)))) / a[i][0]
    return b


class Line:
    """A body across the crack: spans h with n Gauss points each; `half` starts at a line of symmetry, x = 0."""

    def __init__(self, degree, points, h, half=False):
        self.degree, self.points = degree, points
        reach = round(HALF_LENGTH / h)
        spans = reach if half else 2 * reach
        self.middle = 0 if half else reach            # the span right of x = 0
        start = 0.0 if half else -reach * h
        knots = [start + h * min(max(i - degree, 0), spans) for i in range(spans + 2 * degree + 1)]
        self.unknowns = spans + degree
        self.rows = []                                # (first unknown, values, slopes, weight, x)
        for span in range(spans):
            for place, weight in zip(*GAUSS[points]):
                x = start + h * (span + 0.5 + 0.5 * place)
                self.rows.append((span, *basis(knots, degree, span + degree, x), 0.5 * h * weight, x))

    def index(self, span, point):
        return (self.middle + span) * self.points + point

    def minimise(self, strengths):
        """Cost and the values of c at all points; strengths: {index of a point: B}."""
        bands = [[0.0] * (self.degree + 1) for _ in range(self.unknowns)]
        right = [0.0] * self.unknowns
        for q, (first, values, slopes, weight, _) in enumerate(self.rows):
            local = weight * (1 + strengths.get(q, 0.0)) / 4
            for i in range(self.degree + 1):
                right[first + i] += weight * values[i] / 4
                for j in range(i, self.degree + 1):
                    bands[first + i][j - i] += local * values[i] * values[j] + weight * slopes[i] * slopes[j]
        unknown = solve(bands, right)
        cost, field = 0.0, []
        for first, values, slopes, weight, _ in self.rows:
            c = sum(v * unknown[first + i] for i, v in enumerate(values))
            slope = sum(s * unknown[first + i] for i, s in enumerate(slopes))
            cost += weight * ((1 - c) ** 2 / 4 + slope ** 2)
            field.append(c)
        return cost, field

    def cost(self, broken, strength=BROKEN):
        return self.minimise({q: strength for q in broken})[0]


def cases(degree, n, h, strength=BROKEN):
    """Costs by name. Half models count both sides."""
    full, half = Line(degree, n, h), Line(degree, n, h, half=True)
    at = full.index
    return {
        "one_row": min(full.cost([at(0, q)], strength) for q in range((n + 1) // 2)),
        **{f"one_row_b{b}": min(full.cost([at(0, q)], b) for q in range((n + 1) // 2)) for b in (10, 100, 1000)},
        "one_row_dearest": max(full.cost([at(0, q)], strength) for q in range((n + 1) // 2)),
        "two_rows_across_knot": full.cost([at(-1, n - 1), at(0, 0)], strength),
        "two_rows_in_span": min(full.cost([at(0, q), at(0, q + 1)], strength) for q in range(n - 1)),
        "three_rows": min(full.cost([at(0, 0) + q + s for s in range(3)], strength) for q in range(n)),
        "span": full.cost([at(0, q) for q in range(n)], strength),
        "four_rows_across_knot": full.cost([at(0, 0) + s for s in (-2, -1, 0, 1)], strength),
        "two_spans": full.cost([at(s, q) for s in (-1, 0) for q in range(n)], strength),
        "symmetry_one_row": 2 * half.cost([0], strength),
        "symmetry_two_rows": 2 * half.cost([0, 1], strength),
    }


def cost_at1(degree, points, h, strength):
    """Cost of a crack of AT1 with one broken row, by Gauss-Seidel with bounds."""
    line = Line(degree, points, h)
    size, b = line.unknowns, 2.0
    matrix, right = [[0.0] * (2 * degree + 1) for _ in range(size)], [0.0] * size
    for q, (first, values, slopes, weight, _) in enumerate(line.rows):
        drive = 2 * weight * strength * 3 / (8 * b) if q == line.index(0, 0) else 0.0
        for i in range(degree + 1):
            right[first + i] += 0.375 * weight * values[i] / b
            for j in range(degree + 1):
                matrix[first + i][degree + j - i] += 0.75 * weight * b * slopes[i] * slopes[j] + drive * values[i] * values[j]
    c, change = [1.0] * size, 1.0
    while change > 1e-12:
        change = 0.0
        for i in range(size):
            near = range(max(0, i - degree), min(size, i + degree + 1))
            others = sum(matrix[i][degree + j - i] * c[j] for j in near if j != i)
            value = min(1.0, max(0.0, (right[i] - others) / matrix[i][degree]))
            change, c[i] = max(change, abs(value - c[i])), value
    cost = 0.0
    for first, values, slopes, weight, _ in line.rows:
        at = [c[first + i] for i in range(degree + 1)]
        value, slope = (sum(f * a for f, a in zip(functions, at)) for functions in (values, slopes))
        cost += 0.375 * weight * ((1 - value) / b + b * slope**2)
    return cost


def main():
    with open(Path(__file__).with_name("crack-cost.csv"), "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        for degree, n in ((1, 2), (2, 2), (2, 3), (3, 2), (3, 3), (3, 4)):
            for h in (2, 1.4, 1, 0.7, 0.5, 0.35, 0.25, 0.125):
                costs = cases(degree, n, h)
                if file.tell() == 0:
                    table.writerow(["degree", "points", "h_over_l0", *costs])
                table.writerow([degree, n, h, *(f"{value:.8f}" for value in costs.values())])
                print(degree, n, h, {name: round(value, 4) for name, value in costs.items()})
    with open(Path(__file__).with_name("crack-cost-at1.csv"), "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["degree", "points", "h_over_l0", "one_row_b1000", "one_row_b10000", "one_row_b1e8"])
        for degree, n in ((1, 2), (2, 2)):
            for h in (2, 1.4, 1, 0.7, 0.5):
                table.writerow([degree, n, h, *(f"{cost_at1(degree, n, h, b):.8f}" for b in (1e3, 1e4, 1e8))])


if __name__ == "__main__":
    main()
