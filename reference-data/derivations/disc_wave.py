"""Two radial modes of a free disc of radius 1: body force and traction on the edge vanish."""

from sympy import Matrix, Rational, besselj, cos, nsolve, sin, sqrt, symbols, zeros

from table import body_force, lam, linear, moduli, mu, quantities, t, write, x, y

first, second = symbols("first second", positive=True)  # wave numbers
r = sqrt(x**2 + y**2)


def mode(k):
    return besselj(1, k * r) / r * Matrix([x, y])


def wave_numbers(given):
    """Roots of sigma_rr(1) = 0 for the radial displacement J1(k r)."""
    k = symbols("k")
    traction = ((lam + 2 * mu) * k * besselj(0, k) - 2 * mu * besselj(1, k)).subs(given)
    return {first: nsolve(traction, k, 2, prec=40), second: nsolve(traction, k, Rational(27, 5), prec=40)}


speed = sqrt(lam + 2 * mu)
u = Rational("0.10") * sin(first * speed * t + Rational("0.7")) * mode(first)
u += Rational("0.05") * cos(second * speed * t) * mode(second)
stress = linear(u.jacobian([x, y]))
for plane in ("strain", "stress"):
    given = moduli(plane, "0.3")
    given |= wave_numbers(given)
    place = {x: Rational(3, 5), y: Rational(4, 5), t: Rational(1, 3)}
    traction = stress * Matrix([Rational(3, 5), Rational(4, 5)])
    print(plane, "traction on the edge:", [abs(f.subs(given).subs(place).evalf(30)) < 1e-25 for f in traction],
          "body force:", [abs(f.subs(given).subs(place).evalf(30)) < 1e-25 for f in body_force(u, stress)])
write("disc-wave", quantities(u, stress, force=zeros(2, 1)), "0.3", more=wave_numbers)
