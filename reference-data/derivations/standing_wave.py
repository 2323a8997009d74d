"""P and S wave between rollers: the body force vanishes, and so do normal displacement and shear on the sides."""

from sympy import Matrix, Rational, cos, pi, simplify, sin, sqrt, zeros

from table import body_force, lam, linear, mu, quantities, t, write, x, y

LX, LY = 1, Rational(4, 5)


def wave_vector(mx, my):
    kx, ky = pi * mx / LX, pi * my / LY
    return kx, ky, sqrt(kx**2 + ky**2)


kx, ky, k = wave_vector(1, 2)
potential = cos(kx * x) * cos(ky * y)
p_wave = Rational("0.10") * sin(k * sqrt(lam + 2 * mu) * t + Rational("0.7")) / k * Matrix([potential.diff(x), potential.diff(y)])

kx, ky, k = wave_vector(2, 1)
stream = sin(kx * x) * sin(ky * y)
s_wave = Rational("0.07") * cos(k * sqrt(mu) * t) / k * Matrix([stream.diff(y), -stream.diff(x)])

u = p_wave + s_wave
stress = linear(u.jacobian([x, y]))
print("body force:", simplify(body_force(u, stress)).T)
for side, end, normal in ((x, 0, 0), (x, LX, 0), (y, 0, 1), (y, LY, 1)):
    print(f"{side} = {end}: normal displacement", simplify(u[normal].subs(side, end)),
          "shear", simplify(stress[0, 1].subs(side, end)))
write("standing-wave", quantities(u, stress, force=zeros(2, 1)), "0.3")
