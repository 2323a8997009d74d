"""A thick ring of Hencky's material, plane strain, that a pressure in its bore has widened: the static state with finite strains.

The ring expands alike in all directions, R -> r(R). With the stretches r' and r/R, their logarithms e_r and e_t, Kirchhoff stresses
tau = lambda (e_r + e_t) + 2 mu e, and first Piola-Kirchhoff stresses P = tau over the stretch,

    dP_r/dR = (P_t - P_r)/R,    P_r = -p r/R at the bore (the pressure acts on the present bore), P_r = 0 at the rim.

Runge-Kutta's method over the radius and bisection for the radius of the bore. Printed are 250, 500 and 1000 steps. Standard library only;
takes 2 s.
"""

import math

NU = 0.3
INNER, OUTER = 1.0, 2.0
LAMBDA, MU = NU / ((1 + NU) * (1 - 2 * NU)), 0.5 / (1 + NU)  # Young's modulus is 1


def radial_stretch(stress, hoop):
    """The stretch with which P_r has a value, by Newton's method."""
    stretch = 1.0
    for _ in range(50):
        tau = (LAMBDA + 2 * MU) * math.log(stretch) + LAMBDA * math.log(hoop)
        change = (tau / stretch - stress) / (((LAMBDA + 2 * MU) - tau) / stretch**2)
        stretch -= change
        if abs(change) < 1e-15:
            break
    return stretch


def rates(radius, state):
    r, stress, _ = state
    hoop = r / radius
    stretch = radial_stretch(stress, hoop)
    e_r, e_t = math.log(stretch), math.log(hoop)
    across = (LAMBDA * (e_r + e_t) + 2 * MU * e_t) / hoop
    energy = (0.5 * LAMBDA * (e_r + e_t) ** 2 + MU * (e_r**2 + e_t**2)) * 2 * math.pi * radius
    return stretch, (across - stress) / radius, energy


def outwards(bore, pressure, steps):
    """Radius, stress and energy at the rim where the bore has a radius."""
    state = (bore, -pressure * bore / INNER, 0.0)
    h = (OUTER - INNER) / steps
    for n in range(steps):
        radius = INNER + n * h
        add = lambda k, part: tuple(s + part * h * x for s, x in zip(state, k))
        k1 = rates(radius, state)
        k2 = rates(radius + h / 2, add(k1, 0.5))
        k3 = rates(radius + h / 2, add(k2, 0.5))
        k4 = rates(radius + h, add(k3, 1.0))
        state = tuple(s + h / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4))
    return state


def inflated(pressure, steps):
    low, high = INNER, 1.3 * INNER
    for _ in range(60):
        bore = 0.5 * (low + high)
        low, high = (bore, high) if outwards(bore, pressure, steps)[1] < 0 else (low, bore)
    rim, _, energy = outwards(bore, pressure, steps)
    return bore, rim, energy


if __name__ == "__main__":
    for pressure in (1e-4, 0.05, 0.1):
        for steps in (250, 500, 1000):
            bore, rim, energy = inflated(pressure, steps)
            print(f"p = {pressure} E, {steps} steps: bore {bore:.9f}, rim {rim:.9f}, energy {energy:.9e}")
