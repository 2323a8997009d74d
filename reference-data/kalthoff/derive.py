"""Values of the test of Kalthoff and Winkler in the limit h -> 0, from runs/*.csv (bilinear elements of 0.5, 0.25, 0.125 mm).

Prints the order that is observed, the limit and its uncertainty of each quantity, as entries of source.toml. Theory has order 1, that of the
singularity at the tip of the slit and of the cost of a crack, and most energies have an order near it: the limit is extrapolated from the
two finest meshes with order 1. Its uncertainty is the distance of the finest mesh from it, which covers every order from 1 up. Where the
observed order is below 1, it is at least the distance of the limit of that order. Where an error changes its sign, two meshes agree by
chance: the uncertainty is at least a quarter of the spread of the three meshes, the whole of it where differences grow or change their
sign and there is no order, and never below 0.05 %, the largest distance of the finest mesh in the elastic runs.
Times at which the crack has a length are extrapolated in the same way; they are known at best to the time in which the crack passes an
element. Its angles have no order: the value is that of the finest mesh, and uncertain by its distance from the next mesh, or by an element
at the length of the crack. Standard library only.
"""

import csv
import math
from pathlib import Path

FOLDER = Path(__file__).parent
ENERGIES = {"external_work_j_per_m": "external-work", "kinetic_j_per_m": "kinetic-energy", "elastic_j_per_m": "elastic-energy"}
REACTION = {"reaction_n_per_m": "reaction"}
FRACTURE = {"fracture_j_per_m": "fracture-increment"}
SIZES = ("0.5", "0.25", "0.125")  # mm
FLOOR = 5e-4
TIP = (50.0, 25.0)  # of the slit, mm
LENGTHS = (5, 15, 25, 35)  # of the crack, mm


def load(name):
    with open(FOLDER / "runs" / f"{name}.csv") as file:
        return {round(float(row["time_us"]), 4): row for row in csv.DictReader(file)}


def order(coarse, middle, fine):
    """None where the differences grow or change their sign."""
    ratio = (middle - coarse) / (fine - middle) if fine != middle else 0.0
    return math.log2(ratio) if ratio > 1 else None


def note(values):
    observed = order(*values)
    return "no order on the three meshes" if observed is None else f"order {observed:.2f} on the three meshes"


def extrapolated(values, floor):
    """Limit with order 1 and its uncertainty, which is at least `floor`."""
    difference = values[2] - values[1]
    limit = values[2] + difference
    spread = max(values) - min(values)
    uncertainty = max(abs(difference), spread / 4, floor)
    observed = order(*values)
    if observed is None:
        uncertainty = max(uncertainty, spread)
    elif observed < 1:
        uncertainty = max(uncertainty, abs(values[2] + difference / (2**observed - 1) - limit))
    return limit, uncertainty


def entry(name, unit, value, uncertainty, remark):
    print(f'[[value]]\nname = "{name}"\nunit = "{unit}"\nvalue = {value:.6g}\nuncertainty = {uncertainty:.2g}\nnote = "{remark}"\n')


def energies(name, runs, times, columns):
    for time in times:
        for column, quantity in columns.items():
            values = [float(run[time][column]) for run in runs]
            unit = "N/m" if quantity == "reaction" else "J/m"
            floor = FLOOR * (2 * values[2] - values[1])
            entry(f"{name}/{quantity}-{time:.0f}-us", unit, *extrapolated(values, floor), note(values))


def grown(run, length):
    """Time (us) and angle (degrees) at which the tip is so far from that of the slit, and the speed there (mm/us)."""
    tips = [(time, float(row["tip_x_mm"]) - TIP[0], float(row["tip_y_mm"]) - TIP[1]) for time, row in sorted(run.items())]
    tips = [tip for tip in tips if tip[1] > 0]
    after = next(k for k, (_, x, y) in enumerate(tips) if math.hypot(x, y) >= length)
    (t0, x0, y0), (t1, x1, y1) = tips[after - 1], tips[after]
    near, far = math.hypot(x0, y0), math.hypot(x1, y1)
    part = (length - near) / (far - near)
    x, y = x0 + part * (x1 - x0), y0 + part * (y1 - y0)
    return t0 + part * (t1 - t0), math.degrees(math.atan2(y, x)), (far - near) / (t1 - t0)


for plane in ("plane-strain", "plane-stress"):
    energies(f"elastic/{plane}", [load(f"elastic-{plane}-h{size}") for size in SIZES], (20.0, 30.0), {**ENERGIES, **REACTION})
    for model in ("at1", "at2"):
        cracked = [load(f"{model}-{plane}-h{size}") for size in SIZES]
        energies(f"{model}/{plane}", cracked, (30.0, 45.0), {**ENERGIES, **FRACTURE})
        for length in LENGTHS:
            found = [grown(run, length) for run in cracked]
            times, angles = [[row[k] for row in found] for k in (0, 1)]
            element = float(SIZES[2])
            entry(f"{model}/{plane}/time-at-{length}-mm", "us", *extrapolated(times, element / found[2][2]), note(times))
            uncertainty = max(abs(angles[2] - angles[1]), math.degrees(math.atan(element / length)))
            entry(f"{model}/{plane}/angle-at-{length}-mm", "1", angles[2], uncertainty, "degrees; of the finest mesh")
