"""Phase-field equation with given c and H: the source, and the normal derivative on the sides."""

from sympy import Rational as R
from sympy import cos, pi, sin, zeros

from table import quantities, write, x, y

L0, GC, K = R("0.1"), 1, R("0.01")
LX, LY = 1, R("0.8")

history = (2 + y * sin(3 * x)) * GC / (4 * L0 * (1 - K))

FIELDS = {
    "phase-field": R("0.6") + R("0.3") * sin(R("1.7") * x + R("0.3")) * cos(R("2.3") * y - R("0.4")),
    "phase-field-zero-flux": R("0.6") + R("0.25") * cos(pi * x) * cos(2 * pi * y / LY) + R("0.1") * cos(2 * pi * x),
}
for name, c in FIELDS.items():
    source = (4 * L0 * (1 - K) * history / GC + 1) * c - 4 * L0**2 * (c.diff(x, 2) + c.diff(y, 2))
    print(name, "normal derivatives:", [c.diff(s).subs(s, end) for s, end in ((x, 0), (x, LX), (y, 0), (y, LY))])
    write(name, quantities(zeros(2, 1), zeros(2, 2), phase=c, history=history, source=source), "0.3")
