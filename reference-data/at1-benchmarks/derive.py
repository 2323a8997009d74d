"""Values of a pre-strained strip, a ring that a pressure pulse breaks and a plate whose holes stop a crack, in the limit h -> 0, from
runs/*.csv (bilinear quadrilaterals, AT1).

Prints entries of source.toml. The limit is extrapolated from the two finest meshes with order 1, the order of what a crack costs on
linear elements. Its uncertainty is the distance of the finest mesh from it, and at least a quarter of the spread of the three meshes,
since two meshes agree by chance where an error changes its sign. Where the observed order is below 1, or there is none, it is at least
the whole spread, and the distance of the limit of that order.
Standard library only.
"""

import csv
import math
from pathlib import Path

FOLDER = Path(__file__).parent


def load(name):
    with open(FOLDER / "runs" / f"{name}.csv") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def extrapolated(values, ratio, equal):
    """Limit for meshes whose sizes have this ratio (the finest two, where there are other sizes), its uncertainty and a note."""
    coarse, middle, fine = values
    limit = fine + (fine - middle) / (ratio - 1)
    spread = max(values) - min(values)
    uncertainty = max(abs(limit - fine), spread / 4)
    change = (middle - coarse) / (fine - middle) if fine != middle else 0.0
    if change <= 0:
        return limit, max(uncertainty, spread), "no order on the three meshes"
    if not equal:  # the sizes have equal differences: with order 1 the values have too
        if change < 1:
            return limit, max(uncertainty, spread), "an order below 1 on the three meshes"
        return limit, uncertainty, "an order of 1 or more on the three meshes"
    order = math.log(change) / math.log(ratio)
    if order < 1:
        further = abs(fine + (fine - middle) / (change - 1) - limit) if order > 0 else 0.0
        uncertainty = max(uncertainty, further, spread)
    return limit, uncertainty, f"order {order:.2f} on the three meshes"


def entry(name, unit, values, ratio, equal=True):
    limit, uncertainty, note = extrapolated(values, ratio, equal)
    print(f'[[value]]\nname = "{name}"\nunit = "{unit}"\nvalue = {limit:.5g}\nuncertainty = {uncertainty:.2g}\nnote = "{note}"\n')


def slope(x, y):
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def strip(run):
    """Speed of the tip (m/s), and what the whole strip gains per length of the crack (J/m2), from 8 to 18 us."""
    rows = [row for row in run if 8 <= row["time_us"] <= 18]
    tip = [1e-3 * row["tip_x_mm"] for row in rows]
    gains = {name: 2 * slope(tip, [row[f"{name}_j_per_m"] for row in rows]) for name in ("fracture", "kinetic", "elastic")}
    return {"speed": slope([1e-6 * row["time_us"] for row in rows], tip), **gains}


strips = [strip(load(f"strip-h{size}")) for size in ("0.125", "0.0625", "0.03125")]
for quantity, unit in {"speed": "m/s", "fracture": "J/m^2", "kinetic": "J/m^2", "elastic": "J/m^2"}.items():
    entry(f"strip/{quantity}", unit, [values[quantity] for values in strips], 2)
for seed in (1, 2):
    rings = [load(f"ring-{seed}-h{size}") for size in ("1", "0.7", "0.5")]
    for time in (60, 70, 80, 100):
        rows = [next(row for row in ring if row["time_us"] == time) for ring in rings]
        entry(f"ring/seed-{seed}/fracture-energy-{time}-us", "J/m", [row["fracture_j_per_m"] for row in rows], math.sqrt(2))

START = 75.0  # end of the slot, mm


def passed(run, length):
    """Time at which x of the tip is so far from the end of the slot, us."""
    rows = [row for row in run if not math.isnan(row["tip_x_mm"])]
    after = next(k for k, row in enumerate(rows) if row["tip_x_mm"] - START >= length)
    (t0, x0), (t1, x1) = ((row["time_us"], row["tip_x_mm"]) for row in rows[after - 1 : after + 1])
    return t0 + (START + length - x0) / (x1 - x0) * (t1 - t0)


corrected = [load(f"arrest-kappa-h{size}") for size in ("0.05625", "0.0375", "0.01875")]
at_rest = [next(row for row in run if row["time_us"] == 200) for run in corrected]
entry("arrest/length", "mm", [row["tip_x_mm"] - START for row in at_rest], 2, equal=False)
entry("arrest/fracture-energy-200-us", "J/m", [row["fracture_j_per_m"] for row in at_rest], 2, equal=False)
for length in (5, 10, 15):
    entry(f"arrest/time-at-{length}-mm", "us", [passed(run, length) for run in corrected], 2, equal=False)
