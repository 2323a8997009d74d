"""A column of three blocks on a floor: what it settles by if contact forces act through mass-weighted fits.

The blocks of the case `contact/stack` in one dimension: height H = 0.25, modulus and density 1, splines on
equal spans that the blocks cut, equally spaced points in the part of each span that is inside. A contact force
acts on control points with weights `W = N(y) m [a + b (X − x)]`, y half a span inside the boundary at x, X the
Greville abscissae, `Σ W = 1` and `Σ W X = x`, and boundaries follow `Σ W u`. In place of the shape functions at
the boundary such weights add a compliance: a layer that gives way besides, so many spans thick on each side.
"""

from splines import greville, matrices, open_knots, shape_functions, solve

HEIGHT, FOOT = 0.25, 0.07


def points_of(bottom, top, h, count):
    """Equally spaced points of the parts of spans between two heights."""
    points, low = [], bottom
    while low < top - 1e-12:
        high = min(h * int(low / h + 1 + 1e-9), top)
        points += [(low + (high - low) * (k + 0.5) / count, (high - low) / count) for k in range(count)]
        low = high
    return points


def weights(knots, degree, mass, at, inside):
    """Of control points, for the boundary at a height."""
    first, values, _ = shape_functions(knots, degree, inside)
    places = greville(knots, degree)
    parts = [(first + a, v * mass[first + a], places[first + a] - at) for a, v in enumerate(values)]
    m0 = sum(p for _, p, _ in parts)
    m1, m2 = (sum(p * arm**q for _, p, arm in parts) for q in (1, 2))
    scale = m2 * m0 - m1 * m1
    a, b = m2 / scale, -m1 / scale
    return {i: p * (a + b * arm) for i, p, arm in parts}


def shape(knots, degree, at):
    """Shape functions at the boundary, for comparison."""
    first, values, _ = shape_functions(knots, degree, at)
    return {first + a: v for a, v in enumerate(values)}


def settlements(degree, spans_per_block, fitted=True):
    """Of the three blocks, over those of a column."""
    h = HEIGHT / spans_per_block
    knots = open_knots(degree, 4 * spans_per_block, 0.0, 4 * HEIGHT)
    lift, found = 0.0, []
    for block in range(3):
        bottom = FOOT + block * HEIGHT
        points = points_of(bottom, bottom + HEIGHT, h, degree)
        _, mass, stiffness = matrices(knots, degree, points)
        inside = [i for i, m in enumerate(mass) if m > 1e-16]
        if fitted:
            under = weights(knots, degree, mass, bottom, bottom + h / 2)
            above = weights(knots, degree, mass, bottom + HEIGHT, bottom + HEIGHT - h / 2)
        else:
            under, above = shape(knots, degree, bottom), shape(knots, degree, bottom + HEIGHT)
        carried = (2 - block) * HEIGHT
        rows = [[stiffness[i][j] for j in inside] + [under.get(i, 0.0)] for i in inside]
        rows.append([under.get(j, 0.0) for j in inside] + [0.0])
        right = [-mass[i] - carried * above.get(i, 0.0) for i in inside] + [lift]
        u = dict(zip(inside, solve(rows, right)))
        mean = sum(mass[i] * u[i] for i in inside) / HEIGHT
        column = (4 / 3, 10 / 3, 13 / 3)[block] * HEIGHT**2
        found.append(-mean / column)
        lift = sum(w * u[i] for i, w in above.items())
    return found


if __name__ == "__main__":
    for degree, spans in ((2, 8), (3, 8), (2, 16)):
        for fitted in (True, False):
            found = settlements(degree, spans, fitted)
            layer = (found[2] - 1) * (13 / 3) / 9 * spans
            words = "fitted weights" if fitted else "shape functions"
            print(f"p={degree}, h=H/{spans}, {words}:", *(f"{f:.3f}" for f in found), f"layer {layer:.2f} spans")
