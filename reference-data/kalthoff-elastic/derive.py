"""Values of the elastic test of Kalthoff and Winkler in the limit h -> 0, from runs/*.csv (bilinear elements of 0.5, 0.25, 0.125 mm).

Prints the order that is observed, the limit and its uncertainty of each quantity at 20 and 30 us, as entries of source.toml. From 15 us on
energies converge with order 1, that of the singularity at the tip of the slit: the limit is extrapolated from the two finest meshes with
order 1. Its uncertainty is the distance of the finest mesh from it, so that it covers every order from 1 up, and at least 0.05 %, the
largest of these distances: where an error changes its sign, two meshes agree by chance. Standard library only.
"""

import csv
import math
from pathlib import Path

FOLDER = Path(__file__).parent
QUANTITIES = {"external_work_j_per_m": "external-work", "kinetic_j_per_m": "kinetic-energy", "elastic_j_per_m": "elastic-energy", "reaction_n_per_m": "reaction"}
SIZES = ("0.5", "0.25", "0.125")  # mm
FLOOR = 5e-4


def load(name):
    with open(FOLDER / "runs" / f"{name}.csv") as file:
        return {round(float(row["time_us"]), 4): row for row in csv.DictReader(file)}


for plane in ("plane-strain", "plane-stress"):
    runs = [load(f"{plane}-h{size}") for size in SIZES]
    for time in (20.0, 30.0):
        for column, name in QUANTITIES.items():
            coarse, middle, fine = (float(run[time][column]) for run in runs)
            ratio = (middle - coarse) / (fine - middle)
            order = f"{math.log2(ratio):.2f}" if ratio > 0 else "none"
            unit, limit = ("N/m" if name == "reaction" else "J/m"), 2 * fine - middle
            print(f'[[value]]\nname = "{plane}/{name}-{time:.0f}-us"\nunit = "{unit}"\nvalue = {limit:.6g}')
            print(f'uncertainty = {max(abs(fine - middle), FLOOR * limit):.2g}\nnote = "order {order} on the three meshes"\n')
