"""Elastodynamics with a phase field in tension: body force from the degraded stress, source from psi+."""

from sympy import Matrix, cos, sin
from sympy import Rational as R

from table import linear, quantities, t, write, x, y

L0, GC, K = R("0.1"), R("0.02"), 0

alpha = R("0.20") + R("0.15") * sin(R("1.2") * t + R("0.1"))
beta = R("0.15") + R("0.10") * t + R("0.08") * t**2
u = Matrix([
    alpha * (x + R("0.15") * sin(R("1.7") * x + R("0.9") * y + R("0.3"))),
    beta * (y + R("0.12") * cos(R("1.1") * x - R("1.4") * y + R("0.5"))),
])
c = R("0.7") + R("0.25") * sin(R("1.9") * x - R("0.6") + R("0.5") * t) * cos(R("1.3") * y + R("0.4") - R("0.8") * t)

gradient = u.jacobian([x, y])
strain = (gradient + gradient.T) / 2
intact = linear(gradient)
history = (intact * strain).trace() / 2
source = (4 * L0 * (1 - K) * history / GC + 1) * c - 4 * L0**2 * (c.diff(x, 2) + c.diff(y, 2))
degradation = (1 - K) * c**2 + K
write("coupled", quantities(u, degradation * intact, phase=c, history=history, source=source), "0.3")
