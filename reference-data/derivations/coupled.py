"""Elastodynamics with a phase field: body force from the degraded stress, source from the energy that drives the crack.

In tension both principal strains are positive; squeezed, one is positive, the other and the trace are negative."""

from sympy import Matrix, Rational as R, cos, eye, pi, sin, sqrt, symbols

from table import lam, linear, moduli, mu, quantities, t, write, x, y

L0, NU = R("0.1"), R("0.3")
bulk = symbols("bulk", positive=True)

alpha = R("0.20") + R("0.15") * sin(R("1.2") * t + R("0.1"))
beta = R("0.15") + R("0.10") * t + R("0.08") * t**2
shape = Matrix([
    x + R("0.15") * sin(R("1.7") * x + R("0.9") * y + R("0.3")),
    y + R("0.12") * cos(R("1.1") * x - R("1.4") * y + R("0.5")),
])
tension = Matrix([alpha * shape[0], beta * shape[1]])
squeezed = Matrix([alpha / 2 * shape[0], -(2 * beta + R("0.05")) * shape[1]])
rising = R("0.7") + R("0.25") * sin(R("1.9") * x - R("0.6") + R("0.5") * t) * cos(R("1.3") * y + R("0.4") - R("0.8") * t)
falling = (R("0.75") + R("0.12") * sin(R("1.9") * x - R("0.6")) * cos(R("1.3") * y + R("0.4"))
           - R("0.4") * t * (1 + R("0.2") * sin(x + y)))


def bulk_modulus(given):
    """Twice the energy of the change of volume over the square of the trace of the strain in the plane."""
    solid = R(1) / (3 * (1 - 2 * NU))
    is_strain = given[lam] == moduli("strain", NU)[lam]
    return {bulk: solid if is_strain else solid * ((1 - 2 * NU) / (1 - NU)) ** 2}


def principal(tensor):
    mean, half = tensor.trace() / 2, (tensor[0, 0] - tensor[1, 1]) / 2
    radius = sqrt(half**2 + tensor[0, 1] ** 2)
    return mean + radius, mean - radius


def split(name, gradient):
    """Stress that is degraded, and the energy that drives."""
    strain = (gradient + gradient.T) / 2
    intact, trace = linear(gradient), strain.trace()
    energy = (intact * strain).trace() / 2
    if name == "whole":
        return intact, energy
    if name == "rankine":
        return intact, principal(intact)[0] ** 2 / 2
    if name == "spectral":
        e1, e2 = principal(strain)
        return 2 * mu * e1 * (strain - e2 * eye(2)) / (e1 - e2), mu * e1**2
    kept = {"volumetric-deviatoric": 1, "star-convex": R("1.2")}[name] * bulk
    return intact - kept * trace * eye(2), energy - kept * trace**2 / 2


def coupled(name, u, c, gc, which, g, local, diffusion):
    gradient = u.jacobian([x, y])
    driven, history = split(which, gradient)
    d = symbols("d")
    half_slope = g(d).diff(d).subs(d, c) / 2
    source = 4 * L0 * history / gc * half_slope + local - diffusion * L0**2 * (c.diff(x, 2) + c.diff(y, 2))
    stress = linear(gradient) + (g(c) - 1) * driven
    write(name, quantities(u, stress, phase=c, history=history, source=source), NU, more=bulk_modulus)


def cohesive(power, a2, a3, gc=R("0.01"), strength=R("0.12")):
    a1 = 2 * gc / (pi * L0 * strength**2)
    return lambda c: c**power / (c**power + a1 * (1 - c) * (1 + a2 * (1 - c) + a2 * a3 * (1 - c) ** 2))


quadratic = lambda c: c**2
concave = 2 / pi * (1 - falling)
coupled("coupled", tension, rising, R("0.02"), "whole", quadratic, rising, 4)
coupled("coupled-at1", squeezed, falling, R("0.01"), "spectral", quadratic, 0, 3)
coupled("coupled-linear", tension, falling, R("0.01"), "rankine", cohesive(2, R("-0.5"), 0), concave, 8 / pi)
coupled("coupled-exponential", squeezed, falling, R("0.01"), "volumetric-deviatoric",
        cohesive(R("2.5"), 2 ** R("5/3") - 3, 0), concave, 8 / pi)
coupled("coupled-cornelissen", squeezed, falling, R("0.01"), "star-convex",
        cohesive(2, R("1.3868"), R("0.6567")), concave, 8 / pi)
