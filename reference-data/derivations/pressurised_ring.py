"""Energies of a thick ring under a pressure pulse in its bore, plane stress, before it fractures; and the time at which AT1 begins there.

The ring expands alike in all directions, so its displacement is radial: linear elements over the radius, lumped mass, central differences.
The pressure rises within some microseconds. Energies converge with order 2; printed are 250, 500 and 1000 elements, and the limit
with order 2 from the last two. Energies are of the whole ring, J per metre of thickness. Standard library only; takes 10 s.
"""

import math

E, NU, RHO = 210e9, 0.3, 7850.0
INNER, OUTER = 0.08, 0.15
PRESSURE, RISE, DECAY = 400e6, 2e-6, 100e-6
GC, B = 20e3, 1.5e-3  # toughness and length of AT1
TIMES = (10e-6, 20e-6, 30e-6, 40e-6)
END = 70e-6


def pressure(t):
    return PRESSURE * math.exp(-t / DECAY) * (1 - math.exp(-((t / RISE) ** 2)))


def run(elements):
    h = (OUTER - INNER) / elements
    stiff = E / (1 - NU * NU)
    speed = math.sqrt(stiff / RHO)
    dt = 10e-6 / math.ceil(10e-6 / (0.9 * h / speed))  # all times fall on steps
    steps = math.ceil(END / dt)
    middle = [INNER + (j + 0.5) * h for j in range(elements)]
    radius = [INNER + j * h for j in range(elements + 1)]
    mass = [RHO * r * h for r in radius]
    mass[0], mass[-1] = RHO * h * (0.5 * INNER + h / 8), RHO * h * (0.5 * OUTER - h / 8)
    u, v = [0.0] * (elements + 1), [0.0] * (elements + 1)
    strength = math.sqrt(3 * E * GC / (8 * B))  # of a uniform stress, where the driving energy is that of the largest principal stress
    rows, work, onset, before = [], 0.0, None, None
    for n in range(steps + 1):
        t = n * dt
        radial = [(b - a) / h for a, b in zip(u, u[1:])]
        hoop = [(a + b) / (2 * r) for a, b, r in zip(u, u[1:], middle)]
        along = [stiff * (e + NU * k) * r / h for e, k, r in zip(radial, hoop, middle)]  # times r, over h
        across = [stiff * (k + NU * e) * 0.5 for e, k in zip(radial, hoop)]  # half of it to each node
        force = [0.0] * (elements + 1)
        for j in range(elements):
            force[j] += h * (along[j] - across[j])
            force[j + 1] -= h * (along[j] + across[j])
        load = pressure(t) * INNER
        force[0] += load
        kick = 0.5 * dt if n == 0 else dt
        new = [a + kick * f / m for a, f, m in zip(v, force, mass)]
        if any(abs(t - time) < 0.5 * dt for time in TIMES):
            kinetic = sum(0.5 * m * a * b for m, a, b in zip(mass, v, new))
            elastic = sum(0.5 * stiff * (e * e + k * k + 2 * NU * e * k) * r * h for e, k, r in zip(radial, hoop, middle))
            rows.append((t, *(2 * math.pi * energy for energy in (work, kinetic, elastic))))
        # at the bore: the radial stress is the pressure
        tension = E * u[0] / INNER - NU * pressure(t)
        if onset is None and tension >= strength:
            onset = t - dt * (tension - strength) / (tension - before)
        before = tension
        work += 0.5 * load * new[0] * dt
        v = new
        u = [a + dt * b for a, b in zip(u, v)]
        load = pressure(t + dt) * INNER
        work += 0.5 * load * new[0] * dt
    return rows, onset


found = [run(n) for n in (250, 500, 1000)]
for rows in zip(*(rows for rows, _ in found)):
    print(f"{rows[0][0] * 1e6:.0f} us")
    for k, name in enumerate(("work", "kinetic energy", "elastic energy"), 1):
        print(f"  {name}: " + ", ".join(f"{row[k]:.2f}" for row in rows) + f"; limit {(4 * rows[2][k] - rows[1][k]) / 3:.2f} J/m")
times = [onset * 1e6 for _, onset in found]
print("AT1 begins at the bore: " + ", ".join(f"{t:.4f}" for t in times) + f"; limit {(4 * times[2] - times[1]) / 3:.4f} us")
