"""Common to all derivations: symbols, moduli, and the table of a solution at fixed points."""

import csv
from pathlib import Path

import sympy as sp

x, y, t = sp.symbols("x y t", real=True)
lam, mu = sp.symbols("lam mu", positive=True)

# Places inside [0, 1] x [0, 0.8] and times, without pattern.
POINTS = [
    ("0.13", "0.07", "0"), ("0.29", "0.71", "0.11"), ("0.47", "0.22", "0.35"),
    ("0.61", "0.58", "0.52"), ("0.83", "0.34", "0.76"), ("0.97", "0.79", "0.93"),
]


def moduli(plane, nu, young=1):
    """Lame's parameters of the in-plane tensor: lam* and mu."""
    nu = sp.Rational(nu)
    first = young * nu / ((1 + nu) * (1 - 2 * nu))
    shear = young / (2 * (1 + nu))
    return {mu: shear, lam: first if plane == "strain" else 2 * first * shear / (first + 2 * shear)}


def linear(grad):
    """lam* tr(e) I + 2 mu e."""
    strain = (grad + grad.T) / 2
    return lam * strain.trace() * sp.eye(2) + 2 * mu * strain


def body_force(u, stress, density=1):
    """rho a - Div P."""
    return density * u.diff(t, 2) - stress.diff(x)[:, 0] - stress.diff(y)[:, 1]


def quantities(u, stress, force=None, phase=None, history=None, source=None):
    """Expressions by name of column."""
    force = body_force(u, stress) if force is None else force
    columns = {"u": u[0], "v": u[1]}
    columns |= {f"{n}_{d}": e.diff(d) for n, e in zip("uv", u) for d in (x, y)}
    columns |= {"u_t": u[0].diff(t), "v_t": u[1].diff(t), "u_tt": u[0].diff(t, 2), "v_tt": u[1].diff(t, 2)}
    columns |= {"p_xx": stress[0, 0], "p_xy": stress[0, 1], "p_yx": stress[1, 0], "p_yy": stress[1, 1]}
    columns |= {"b_x": force[0], "b_y": force[1]}
    if phase is not None:
        columns |= {"c": phase, "c_x": phase.diff(x), "c_y": phase.diff(y), "history": history, "source": source}
    return columns


def write(name, columns, nu, points=POINTS, more=lambda given: {}):
    """Evaluates with 30 digits in both plane states and writes 17 of them to <name>.csv; `more` gives values of other
    symbols from the moduli."""
    with open(Path(__file__).parent / f"{name}.csv", "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["plane", "x", "y", "t", *columns])
        for plane in ("strain", "stress"):
            given = moduli(plane, nu)
            given |= more(given)
            for px, py, pt in points:
                at = {x: sp.Rational(px), y: sp.Rational(py), t: sp.Rational(pt)}
                # The number that Rust reads from the table is the nearest double of the decimal.
                at = {symbol: sp.Rational(float(value)) for symbol, value in at.items()}
                values = [sp.sympify(e).subs(given).subs(at).evalf(30) for e in columns.values()]
                table.writerow([plane, px, py, pt, *(f"{float(v):.17g}" for v in values)])
    print(f"{name}.csv written")
