"""Values of the plate with AT1 in the limit h -> 0, from runs/*.csv (bilinear elements of 0.125, 0.0833 and 0.0625 mm).

Prints the order that is observed, the limit and its uncertainty of each quantity, as entries of source.toml. What a crack costs on a mesh is
of order 1, so the limit is extrapolated from the two finest meshes with order 1; its uncertainty is the larger of the distance of the finest
mesh from it and the distance of the limit that the two coarser meshes give. Standard library only.
"""

import csv
import math
from pathlib import Path

FOLDER = Path(__file__).parent
SIZES = (("0.125", 1 / 8), ("0.0833", 1 / 12), ("0.0625", 1 / 16))  # mm
COLUMNS = {
    "kinetic_j_per_m": ("kinetic-energy", "J/m"),
    "elastic_j_per_m": ("elastic-energy", "J/m"),
    "external_work_j_per_m": ("external-work", "J/m"),
    "fracture_j_per_m": ("fracture-increment", "J/m"),
    "tip_x_mm": ("tip-x", "mm"),
}


def load(name):
    with open(FOLDER / "runs" / f"{name}.csv") as file:
        return {round(float(row["time_us"]), 4): row for row in csv.DictReader(file)}


def limit(coarse, fine):
    """Of two meshes (value, h), with order 1."""
    (a, h), (b, g) = coarse, fine
    return b + (b - a) * g / (h - g)


def order(values):
    """Order p for which f0 + a h^p passes through the three meshes, if there is one between 0.1 and 5."""
    (a, h), (b, g), (c, k) = values
    if (b - a) * (c - b) <= 0:
        return "no order"
    misfit = lambda p: abs((h**p - g**p) / (g**p - k**p) - (a - b) / (b - c))
    orders = [0.1 + 0.01 * n for n in range(491)]
    best = min(orders, key=misfit)
    return f"order {best:.2f}" if orders[0] < best < orders[-1] else "no order"


runs = [(load(f"h{name}"), h) for name, h in SIZES]
for time in (20.0, 40.0, 60.0):
    for column, (quantity, unit) in COLUMNS.items():
        values = [(float(run[time][column]), h) for run, h in runs]
        found = limit(values[1], values[2])
        uncertainty = max(abs(values[2][0] - found), abs(limit(values[0], values[1]) - found))
        print(f'[[value]]\nname = "{quantity}-{time:.0f}-us"\nunit = "{unit}"\nvalue = {found:.6g}\nuncertainty = {uncertainty:.2g}')
        print(f'note = "{order(values)} on the three meshes"\n')
