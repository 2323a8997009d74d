"""Patch test with cubic splines on open knots and equally spaced points: how far the stress is from constant.

A rectangle of 1 by 0.8 m with 8 x 8 spans, nu = 0.3, plane strain, n x n points of equal volume in the middle
of equal parts of every span. It is loaded by the tractions of a unit stress xx or yy at n equally spaced points
per span of its sides, and held at three control values. Assembled and solved here from the shape functions
alone; nothing is taken from the solver.
"""

from splines import open_knots, shape_functions, solve

DEGREE, SPANS, SIZE, NU = 3, 8, (1.0, 0.8), 0.3
LAMBDA, MU = NU / ((1 + NU) * (1 - 2 * NU)), 1 / (2 * (1 + NU))


def middles(n, size):
    return [size * (i + 0.5) / (n * SPANS) for i in range(n * SPANS)]


def largest_errors(n):
    """Largest error of the stress at a point under a unit stress xx, and yy."""
    knots = [open_knots(DEGREE, SPANS, 0.0, size) for size in SIZE]
    count = SPANS + DEGREE
    number = lambda i, j, c: 2 * (j * count + i) + c
    points = []
    for y in middles(n, SIZE[1]):
        for x in middles(n, SIZE[0]):
            (i, nx, dx), (j, ny, dy) = shape_functions(knots[0], DEGREE, x), shape_functions(knots[1], DEGREE, y)
            points.append([(i + a, j + b, dx[a] * ny[b], nx[a] * dy[b]) for a in range(4) for b in range(4)])
    volume = SIZE[0] * SIZE[1] / len(points)
    size = 2 * count * count
    k = [[0.0] * size for _ in range(size)]
    for functions in points:
        for i, j, ax, ay in functions:
            row_x, row_y = k[number(i, j, 0)], k[number(i, j, 1)]
            for a, b, bx, by in functions:
                at = number(a, b, 0)
                row_x[at] += volume * ((LAMBDA + 2 * MU) * ax * bx + MU * ay * by)
                row_x[at + 1] += volume * (LAMBDA * ax * by + MU * ay * bx)
                row_y[at] += volume * (LAMBDA * ay * bx + MU * ax * by)
                row_y[at + 1] += volume * ((LAMBDA + 2 * MU) * ay * by + MU * ax * bx)
    held = [number(0, 0, 0), number(0, 0, 1), number(count - 1, 0, 1)]
    for at in held:
        for other in range(size):
            k[at][other] = k[other][at] = 0.0
        k[at][at] = 1.0
    errors = []
    for c in (0, 1):
        force = [0.0] * size
        along = middles(n, SIZE[1 - c])
        for place in along:
            first, values, _ = shape_functions(knots[1 - c], DEGREE, place)
            for a, value in enumerate(values):
                part = value * SIZE[1 - c] / len(along)
                for end, sign in ((0, -1.0), (count - 1, 1.0)):
                    at = number(end, first + a, c) if c == 0 else number(first + a, end, c)
                    force[at] += sign * part
        for at in held:
            force[at] = 0.0
        u = solve(k, force)
        worst = 0.0
        for functions in points:
            e = [0.0] * 4
            for a, b, gx, gy in functions:
                ux, uy = u[number(a, b, 0)], u[number(a, b, 1)]
                e = [e[0] + ux * gx, e[1] + uy * gy, e[2] + ux * gy, e[3] + uy * gx]
            trace = LAMBDA * (e[0] + e[1])
            stress = (trace + 2 * MU * e[0], trace + 2 * MU * e[1], MU * (e[2] + e[3]))
            exact = (1.0, 0.0, 0.0) if c == 0 else (0.0, 1.0, 0.0)
            worst = max(worst, *(abs(s - t) for s, t in zip(stress, exact)))
        errors.append(worst)
    return errors


if __name__ == "__main__":
    for n in (2, 3, 4, 5):
        xx, yy = largest_errors(n)
        print(f"{n} x {n} points: {xx:.6f} under xx, {yy:.6f} under yy")
