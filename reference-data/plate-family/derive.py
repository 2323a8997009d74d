"""The reference of the impact-loaded plate, from two discretisations that share no code.

Reads runs/*.csv: bilinear elements (`elements-*`) and quadratic splines (`splines-*`) with spans or elements of l0/2 to l0/8 where the crack runs,
with Gc = 3 J/m2 and with Gc divided by the cost of one broken row of points (`-kappa`). Writes plane-strain.csv and mesh-study.csv,
prints the orders that were observed, the estimates, the uncertainties and the events for source.toml. Standard library only.

Each family gives an estimate of the limit h -> 0: with Gc by extrapolation of its three finest meshes with order 1, that of the cost of
a crack, and with Gc/kappa, where this cost is taken away and meshes hardly differ, by its finest mesh. The reference is the mean of the
four estimates. Its uncertainty is the largest distance from the mean of any of them, and of cubic splines with Gc/kappa, which take no
part in the mean. Printed beside it: the order that is observed, and what other extrapolations would give, with order 2 alone (it leaves the
cost of the crack in) and with orders 1 and 2 together on four meshes.
"""

import csv
import math
from pathlib import Path

FOLDER = Path(__file__).parent
QUANTITIES = ["kinetic_j_per_m", "elastic_j_per_m", "external_work_j_per_m", "fracture_increment_j_per_m", "tip_x_mm", "tip_y_mm"]
# family: meshes (file, h over l0) from fine to coarse; whether the limit is extrapolated
FAMILIES = {
    "elements": ([("elements-h8", 1 / 8), ("elements-h5", 1 / 5), ("elements-h4", 1 / 4), ("elements-h3", 1 / 3)], True),
    "splines": ([("splines-h6", 1 / 6), ("splines-h4", 1 / 4), ("splines-h3", 1 / 3), ("splines-h2", 1 / 2)], True),
    "elements, Gc/kappa": ([("elements-h5-kappa", 1 / 5), ("elements-h4-kappa", 1 / 4), ("elements-h3-kappa", 1 / 3)], False),
    "splines, Gc/kappa": ([("splines-h6-kappa", 1 / 6), ("splines-h4-kappa", 1 / 4), ("splines-h3-kappa", 1 / 3)], False),
}
ORDER = 1  # of the cost of a crack
OTHERS = {"order 2": (3, (2,)), "orders 1 and 2": (4, (1, 2))}  # meshes and powers of other extrapolations
WITNESS = ("cubics, Gc/kappa", "cubics-h3-kappa")
AXIS, OFF_AXIS, EDGE, ONSET = 20.0, 0.25, 99.5, 50.5      # mm
START, FRACTURE_START, END = 5.0, 30.0, 80.0               # us


def load(name):
    with open(FOLDER / "runs" / f"{name}.csv") as file:
        rows = list(csv.DictReader(file))
    return {key: [float(row[key]) for row in rows] for key in rows[0]}


def order(meshes, quantity):
    """Order p from 0.2 to 4 for which f0 + a h^p is nearest to the meshes, rms over the second half of the run."""
    runs = [(load(name), h) for name, h in meshes]
    rows = [i for i, t in enumerate(runs[0][0]["time_us"]) if t >= 40.0]

    def misfit(p):
        total = 0.0
        for i in rows:
            x, y = [h**p for _, h in runs], [run[quantity][i] for run, _ in runs]
            mx, my = sum(x) / len(x), sum(y) / len(y)
            slope = sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)
            total += sum((b - my - slope * (a - mx)) ** 2 for a, b in zip(x, y))
        return total

    return min((0.2 + 0.05 * k for k in range(77)), key=misfit)


def weights_at_zero(spacings, powers):
    """Weights of meshes in the value at h = 0 of the least-squares fit of f0 + sum of a_p h^p."""
    rows = [[1.0] + [h**p for p in powers] for h in spacings]
    size = len(rows[0])
    normal = [[sum(row[i] * row[j] for row in rows) for j in range(size)] + [float(i == 0)] for i in range(size)]
    for i in range(size):  # Gauss-Jordan: the last column becomes the first row of the inverse
        pivot = normal[i][i]
        normal[i] = [value / pivot for value in normal[i]]
        for k in range(size):
            if k != i:
                factor = normal[k][i]
                normal[k] = [a - factor * b for a, b in zip(normal[k], normal[i])]
    return [sum(normal[i][size] * row[i] for i in range(size)) for row in rows]


def estimate(meshes, powers):
    """Limit h -> 0 by a fit with these powers of h, or without any the finest mesh."""
    fine = load(meshes[0][0])
    if not powers:
        return fine
    runs, weights = [load(name) for name, _ in meshes], weights_at_zero([h for _, h in meshes], powers)
    out = {"time_us": fine["time_us"]}
    for quantity in QUANTITIES:
        out[quantity] = [sum(w * run[quantity][i] for w, run in zip(weights, runs)) for i in range(len(fine["time_us"]))]
    return out


def crossing(times, values, goal):
    """First time at which values reach goal, between rows."""
    for i in range(1, len(values)):
        if values[i - 1] < goal <= values[i]:
            return times[i - 1] + (times[i] - times[i - 1]) * (goal - values[i - 1]) / (values[i] - values[i - 1])
    return math.nan


def slope(times, values, at, half):
    rows = [i for i, t in enumerate(times) if abs(t - at) <= half + 1e-9]
    mt, mv = sum(times[i] for i in rows) / len(rows), sum(values[i] for i in rows) / len(rows)
    return sum((times[i] - mt) * (values[i] - mv) for i in rows) / sum((times[i] - mt) ** 2 for i in rows)


def events(run):
    t, x, y = run["time_us"], run["tip_x_mm"], run["tip_y_mm"]
    onset = crossing(t, x, ONSET)
    running = next(i for i in range(len(t)) if t[i] >= onset)
    off = next(i for i in range(running, len(t)) if abs(y[i] - AXIS) > OFF_AXIS)
    speeds = [slope(t, x, at, 2.0) for at in t if 2.0 <= at <= t[off] - 2.0]
    edge = next((i for i in range(len(t)) if x[i] >= EDGE), None)
    return {
        "onset-time": onset,
        "branching-time": t[off],
        "branching-x": x[off],
        "largest-speed": 1e3 * max(speeds),
        "right-edge-time": crossing(t, x, EDGE),
        "right-edge-offset": abs(y[edge] - AXIS) if edge is not None else math.nan,
    }


def relative_rms(run, reference, quantity, window):
    """Distance of a run from the reference over a window, as `verify` measures it: relative, of the tip in m."""
    rows = [(t, r) for t, r in zip(reference["time_us"], reference[quantity]) if window[0] - 1e-9 <= t <= window[1] + 1e-9]
    values = [at(run, quantity, t) for t, _ in rows]
    square = sum((v - r) ** 2 for v, (_, r) in zip(values, rows))
    if quantity.startswith("tip"):
        return 1e-3 * math.sqrt(square / len(rows))
    return math.sqrt(square / sum(r * r for _, r in rows))


def at(run, quantity, time):
    times = run["time_us"]
    i = max(k for k, t in enumerate(times) if t <= time + 1e-9)
    if i + 1 == len(times):
        return run[quantity][i]
    weight = (time - times[i]) / (times[i + 1] - times[i])
    return (1 - weight) * run[quantity][i] + weight * run[quantity][i + 1]


SUBMITTED = [(1, "h1"), (0.5, "h2"), (1 / 3, "h3"), (0.25, "h4"), (0.2, "h5"), (0.125, "h8")]
STUDIED = [("kinetic", QUANTITIES[0]), ("elastic", QUANTITIES[1]), ("external_work", QUANTITIES[2]),
           ("fracture_increment", QUANTITIES[3]), ("tip_x", QUANTITIES[4])]


def submitted(name):
    with open(FOLDER.parent / "submissions" / f"independent-fem-{name}" / "history.csv") as file:
        rows = list(csv.DictReader(file))
    run = {key: [float(row[key]) for row in rows] for key in rows[0]}
    run["fracture_increment_j_per_m"] = [f - run["fracture_j_per_m"][0] for f in run["fracture_j_per_m"]]
    return run


def mesh_study(reference, found):
    """mesh-study.csv: what elements of a spacing with Gc are off by; and what two meshes say of the coarser one, for the submissions."""
    onset, branching = found["onset-time"], found["branching-time"]
    phases = {"whole": (START, END), "before_onset": (START, onset), "one_crack": (onset, branching), "branched": (branching, END)}
    head, lines, runs = ["spacing_over_l0"], [], {}
    for row, (h, name) in enumerate(SUBMITTED):
        runs[name] = run = submitted(name)
        line = [f"{h:.9g}"]
        for key, quantity in STUDIED:
            for phase, window in phases.items():
                if key == "fracture_increment" and phase == "whole":
                    window = (FRACTURE_START, END)
                if row == 0:
                    head.append(f"{key}_{phase}")
                line.append(f"{relative_rms(run, reference, quantity, window):.3g}")
        own = events(run)
        for key, unit in (("onset-time", 1e-6), ("branching-time", 1e-6), ("branching-x", 1e-3), ("largest-speed", 1.0),
                          ("right-edge-time", 1e-6), ("right-edge-offset", 1e-3)):
            if row == 0:
                head.append({"largest-speed": "largest_speed_m_per_s"}.get(key, key.replace("-", "_") + ("_s" if unit == 1e-6 else "_m")))
            line.append(f"{abs(own[key] - found[key]) * unit:.3g}")
        lines.append(line)
    with open(FOLDER / "mesh-study.csv", "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(head)
        table.writerows(lines)
    p = 1  # that of the cost of a crack on a mesh: an observed order of 2 would promise more than it keeps
    print(f"\n[uncertainty] of the submissions of elements: 1.25 times the distance of the next mesh, carried to h = 0 with order {p}")
    for (h, name), (other, partner) in zip(SUBMITTED, SUBMITTED[1:] + SUBMITTED[-2:-1]):
        ratio = max(h, other) / min(h, other)
        factor = 1.25 * (ratio**p if h > other else 1.0) / (ratio**p - 1)
        values = [factor * relative_rms(runs[name], runs[partner], quantity, (FRACTURE_START if key == "fracture_increment" else START, END))
                  for key, quantity in STUDIED]
        print(f"  {name}: " + ", ".join(f"{key} = {value:.2g}" for (key, _), value in zip(STUDIED, values)))


def main():
    estimates, shown = {}, {}
    print("orders observed on the three finest and on all meshes")
    for family, (meshes, extrapolated) in FAMILIES.items():
        estimates[family] = estimate(meshes[:3], (ORDER,) if extrapolated else ())
        if extrapolated:
            for quantity in QUANTITIES[:5]:
                print(f"  {family:9} {quantity:28} {order(meshes[:3], quantity):.2f} {order(meshes, quantity):.2f}")
            shown.update({f"{family}, {name}": estimate(meshes[:count], powers) for name, (count, powers) in OTHERS.items()})
    witness = {WITNESS[0]: load(WITNESS[1])}
    times = next(iter(estimates.values()))["time_us"]
    mean = {"time_us": times}
    for quantity in QUANTITIES:
        mean[quantity] = [sum(e[quantity][i] for e in estimates.values()) / len(estimates) for i in range(len(times))]
    with open(FOLDER / "plane-strain.csv", "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["time_us", *QUANTITIES])
        for i, t in enumerate(times):
            table.writerow([f"{t:g}", *(f"{mean[quantity][i]:.6g}" for quantity in QUANTITIES)])
    print("\nestimates at 30, 50, 60, 70, 80 us")
    for quantity in QUANTITIES[:5]:
        for family, run in [*estimates.items(), ("mean", mean), *witness.items(), *shown.items()]:
            values = [run[quantity][times.index(t)] for t in (30, 50, 60, 70, 80)]
            print(f"  {quantity:28} {family:24}", " ".join(f"{value:9.4f}" for value in values))
    print("\nuncertainty: largest distance of an estimate or the witness from the mean")
    for quantity in QUANTITIES:
        start = FRACTURE_START if quantity.startswith("fracture") else START
        rows = [i for i, t in enumerate(times) if start <= t <= END]
        off = [max(abs(e[quantity][i] - mean[quantity][i]) for e in [*estimates.values(), *witness.values()]) for i in rows]
        relative = max(o / abs(mean[quantity][i]) for o, i in zip(off, rows))
        rms = math.sqrt(sum(o * o for o in off) / sum(mean[quantity][i] ** 2 for i in rows))
        part = math.ceil(1e3 * rms) / 1e3
        floor = max((o for o, i in zip(off, rows) if o > part * abs(mean[quantity][i])), default=0.0)
        print(f"  {quantity:28} absolute {max(off):.4g}, relative {relative:.4f}; or {part:.3f} and at least {floor:.3g}")
    print("\nevents: mean and half the range over the families (Gc/kappa and finest meshes)")
    runs = [load(meshes[0][0]) for meshes, _ in FAMILIES.values()]
    found = [events(run) for run in runs]
    means = {name: sum(event[name] for event in found) / len(found) for name in found[0]}
    for name in found[0]:
        values = [event[name] for event in found]
        print(f"  {name:20} {sum(values) / len(values):9.3f} +- {(max(values) - min(values)) / 2:.3f}   ", " ".join(f"{v:.3f}" for v in values))
    mesh_study(mean, means)


if __name__ == "__main__":
    main()
