"""Axis-aligned displacement with the Hencky law axis by axis; rollers on the unit square."""

from sympy import Matrix, Rational, diag, log, pi, sin

from table import lam, mu, quantities, t, write, x, y

A = Rational("0.05")

u = Matrix([A * sin(2 * pi * x) * sin(pi * t), A * sin(2 * pi * y) * sin(pi * t + 2 * pi / 3)])
stretch = [1 + u[0].diff(x), 1 + u[1].diff(y)]
strain = [log(f) for f in stretch]
P = diag(*[(lam * sum(strain) + 2 * mu * e) / f for e, f in zip(strain, stretch)])
print("normal displacement on the sides:", [u[i].subs(s, end) for i, s in enumerate((x, y)) for end in (0, 1)])
write("axis-aligned", quantities(u, P), "0.3")
