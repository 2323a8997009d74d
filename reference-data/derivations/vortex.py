"""Generalised vortex with the Hencky law, by hand in polar coordinates.

With F = Rot(alpha) (I + g e_T x e_R), g = R alpha', the left Cauchy-Green tensor in the rotated polar frame is
B = [[1, g], [g, 1 + g^2]], det B = 1. Its principal values are exp(+-2 e), sinh(e) = g/2, so
ln(B)/2 = e/sinh(2 e) (B - (1 + g^2/2) I). The Rust code differentiates in Cartesian coordinates instead.
"""

from sympy import Matrix, Rational, asinh, cos, exp, eye, factor, pi, simplify, sin, sinh, sqrt, symbols

from table import mu, quantities, t, write, x, y

A = Rational("0.1")
POINTS = [
    ("0.75", "0.0", "0.5"), ("0.62", "0.59", "0"), ("-0.31", "0.97", "0.23"), ("-0.88", "-0.12", "0.5"),
    ("0.21", "-1.15", "0.77"), ("0.93", "-0.64", "0.91"), ("-0.5", "-0.78", "1.4"),
]

R, g = symbols("R g", positive=True)
bump = 1 - 32 * (R - 1) ** 2 + 256 * (R - 1) ** 4
print("bump at 1, 3/4, 5/4:", [bump.subs(R, v) for v in (1, Rational(3, 4), Rational(5, 4))],
      " slope:", [bump.diff(R).subs(R, v) for v in (Rational(3, 4), Rational(5, 4))])
alpha = A * sin(pi * t) * bump

# Hencky stress of simple shear, rotated polar frame. tr(e) = 0, so lam* does not enter.
S = Matrix([[1, 0], [g, 1]])
B = S * S.T
e = symbols("e", positive=True)
print("principal value exp(2 e) of B:", simplify((B - exp(2 * e) * eye(2)).det().subs(g, 2 * sinh(e)).rewrite(exp)))
ratio = asinh(g / 2) / (g * sqrt(1 + g**2 / 4))
tau = 2 * mu * ratio * (B - (1 + g**2 / 2) * eye(2))
P = (tau * S.inv().T).applyfunc(factor)
print("P in the frames (rotated, reference), over 2 mu ratio:", (P / (2 * mu * ratio)).applyfunc(simplify))

shear = R * alpha.diff(R)
P = P.subs(g, shear)
slope = alpha.diff(R)
divergence = Matrix([
    P[0, 0].diff(R) - slope * P[1, 0] + (P[0, 0] - P[1, 1]) / R,
    P[1, 0].diff(R) + slope * P[0, 0] + (P[0, 1] + P[1, 0]) / R,
])
acceleration = Matrix([-R * alpha.diff(t) ** 2, R * alpha.diff(t, 2)])
force = acceleration - divergence

# To Cartesian components: the first index turns by theta + alpha, the second by theta.
radius = sqrt(x**2 + y**2)
polar = Matrix([[x, -y], [y, x]]) / radius
turn = Matrix([[cos(alpha), -sin(alpha)], [sin(alpha), cos(alpha)]])
place = lambda expression: expression.subs(R, radius)
u = place(turn) * Matrix([x, y]) - Matrix([x, y])
write("vortex", quantities(u, place(turn) * polar * place(P) * polar.T, force=place(turn) * polar * place(force)), "0.3", POINTS)
