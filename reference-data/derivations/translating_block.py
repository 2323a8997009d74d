"""A vibrating block that flies, with the Hencky law from the principal values of B.

With principal values b1, b2 of B = F F^T, ln B = ln(b1 b2)/2 I + ln(b1/b2)/(b1 - b2) (B - (b1 + b2)/2 I). The
Rust code uses a series in the deviator instead, and differentiates automatically.
"""

from sympy import Function, Matrix, Rational, eye, log, pi, sin, sqrt

from table import lam, mu, quantities, t, write, x, y

A = Rational("0.06")
V = Matrix([Rational("0.75"), Rational("0.4")])

bump = sin(pi * x) ** 2 * sin(pi * y) ** 2
u = V * t + A * bump * Matrix([sin(2 * pi * t), sin(2 * pi * t + 2)])
F = eye(2) + u.jacobian([x, y])
for side, end in ((x, 0), (x, 1), (y, 0), (y, 1)):
    print(f"{side} = {end}: F - I", (F - eye(2)).subs(side, end))

# Stress as a function of the components of F, so that its divergence is a chain of short derivatives.
f = Matrix(2, 2, [Function(name)(x, y, t) for name in ("f_xx", "f_xy", "f_yx", "f_yy")])
B = f * f.T
mean, radius = B.trace() / 2, sqrt(((B[0, 0] - B[1, 1]) / 2) ** 2 + B[0, 1] ** 2)
b1, b2 = mean + radius, mean - radius
strain = log(b1 * b2) / 4 * eye(2) + (log(b1) - log(b2)) / (4 * radius) * (B - mean * eye(2))
tau = lam * strain.trace() * eye(2) + 2 * mu * strain
P = tau * f.inv().T
given = dict(zip(f, F))
force = u.diff(t, 2) - P.diff(x)[:, 0] - P.diff(y)[:, 1]
stress, force = (e.subs(given).doit() for e in (P, force))
write("translating-block", quantities(u, stress, force=force), "0.3")
