"""Plate with a hole: Kirsch's stresses are in equilibrium, belong to the displacement, and leave the hole free.

The table holds the textbook stresses; the Rust code takes its stress from the displacement instead.
"""

from sympy import Integer, Matrix, Rational, atan2, cos, expand_trig, simplify, sin, sqrt, symbols, zeros

from table import lam, linear, mu, quantities, write, x, y

A, T = Integer(1), Integer(1)
POINTS = [
    ("1.0", "0.0", "0"), ("0.6", "0.8", "0"), ("-0.8", "0.9", "0"),
    ("1.7", "-0.4", "0"), ("0.3", "-2.6", "0"), ("-3.1", "-1.9", "0"),
]

# kappa = 3 - 4 nu in plane strain; (3 - nu)/(1 + nu) is the same in terms of lam*: (lam + 3 mu)/(lam + mu).
kappa = (lam + 3 * mu) / (lam + mu)
r, theta = symbols("r theta", positive=True)
u = T * A / (8 * mu) * Matrix([
    r / A * (kappa + 1) * cos(theta) + 2 * A / r * ((1 + kappa) * cos(theta) + cos(3 * theta)) - 2 * A**3 / r**3 * cos(3 * theta),
    r / A * (kappa - 3) * sin(theta) + 2 * A / r * ((1 - kappa) * sin(theta) + sin(3 * theta)) - 2 * A**3 / r**3 * sin(3 * theta),
])

q = A**2 / r**2
rr = T / 2 * ((1 - q) + (1 - 4 * q + 3 * q**2) * cos(2 * theta))
tt = T / 2 * ((1 + q) - (1 + 3 * q**2) * cos(2 * theta))
rt = -T / 2 * (1 + 2 * q - 3 * q**2) * sin(2 * theta)
rotation = Matrix([[cos(theta), -sin(theta)], [sin(theta), cos(theta)]])
stress = rotation * Matrix([[rr, rt], [rt, tt]]) * rotation.T

print("equilibrium:", simplify(rr.diff(r) + rt.diff(theta) / r + (rr - tt) / r),
      simplify(rt.diff(r) + tt.diff(theta) / r + 2 * rt / r))
print("traction on the hole:", simplify(rr.subs(r, A)), simplify(rt.subs(r, A)), " hoop:", simplify(tt.subs(r, A)))
gradient = Matrix(2, 2, lambda i, j: (
    u[i].diff(r) * rotation[j, 0] + u[i].diff(theta) / r * rotation[j, 1]))
print("stress of the displacement - Kirsch:", simplify((linear(gradient) - stress).applyfunc(expand_trig)))
nu = Rational("0.3")
print("kappa of plane strain, plane stress:", 3 - 4 * nu, (3 - nu) / (1 + nu))

cartesian = {r: sqrt(x**2 + y**2), theta: atan2(y, x)}
write("kirsch", quantities(u.subs(cartesian), stress.subs(cartesian), force=zeros(2, 1)), "0.3", POINTS)
