"""Waves of finite displacement in a bar with nu = 0: P = E (F - 1) needs no body force; P = E ln(F)/F does."""

from sympy import Matrix, Rational, diag, log, pi, simplify, sin, zeros

from table import body_force, quantities, t, write, x

E = 1
A1, A2 = Rational("0.04"), Rational("0.02")

u = Matrix([A1 * sin(pi * x) * sin(pi * t) + A2 * sin(2 * pi * x) * sin(2 * pi * t), 0])
F = 1 + u[0].diff(x)

linear_stress = diag(E * (F - 1), 0)
print("finite-wave, body force:", simplify(body_force(u, linear_stress)).T, " ends:", u[0].subs(x, 0), u[0].subs(x, 1))
write("finite-wave", quantities(u, linear_stress, force=zeros(2, 1)), "0")
write("hencky-wave", quantities(u, diag(E * log(F) / F, 0)), "0")
