"""Smooth static displacement: body force from -Div sigma."""

from sympy import Matrix, cos, exp, sin
from sympy import Rational as R

from table import linear, quantities, write, x, y

u = Matrix([
    R("0.10") * sin(R("1.3") * x + R("0.4")) * cos(R("0.9") * y - R("0.3")) + R("0.03") * exp(R("0.5") * x - R("0.4") * y),
    R("0.08") * cos(R("0.8") * x - R("0.2")) * sin(R("1.7") * y + R("0.6")) + R("0.02") * exp(R("0.6") * y - R("0.3") * x),
])
write("elastostatics", quantities(u, linear(u.jacobian([x, y]))), "0.3")
