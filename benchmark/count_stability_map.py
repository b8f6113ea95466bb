#!/usr/bin/python3
"""The counts of docs/speed_accuracy.md: count_stability_map.py stability_map.csv"""
import csv
import math
import sys

OVERLAP, SWAY = 0.002, 9.0  # of the scene: how deep fingertips press [m]; acceleration at most [m/s^2]
STATIC_FRICTION = 0.8
OUTCOMES = ("stable", "let_go", "ejected", "diverged")


def read(path):
    models = {}
    with open(path) as file:
        for row in csv.DictReader(file):
            model, outcome = row.pop("model"), row.pop("outcome")
            cell = {name: float(value) for name, value in row.items()}
            models.setdefault(model, []).append(dict(cell, outcome=outcome))
    return models


def is_grip(cell):
    """Friction carries the cube at twice the sway's acceleration."""
    pressing = 2 * (cell["contacts"] // 2)
    friction = STATIC_FRICTION * pressing * cell["stiffness_n_m"] * OVERLAP
    return pressing > 0 and friction >= 2.0 * cell["mass_kg"] * SWAY


def beyond_springs(cell):
    """Step beyond 2 / sqrt(N gamma / m)."""
    return cell["step_s"] > 2.0 / math.sqrt(cell["contacts"] * cell["stiffness_n_m"] / cell["mass_kg"])


def beyond_dampers(cell):
    """h^2 N gamma + 2 h N b > 4 m with virtual_spring's b."""
    damping = 2.0 * math.sqrt(cell["stiffness_n_m"] * 0.010)
    step, contacts = cell["step_s"], cell["contacts"]
    return step * step * contacts * cell["stiffness_n_m"] + 2.0 * step * contacts * damping > 4.0 * cell["mass_kg"]


def kick(cell):
    """What one step of a side's force does to the cube [m/s]."""
    return cell["step_s"] * cell["contacts"] * cell["stiffness_n_m"] * OVERLAP / (2.0 * cell["mass_kg"])


def stable(cells):
    return "%d of %d" % (sum(c["outcome"] == "stable" for c in cells), len(cells))


def thrown(cells):
    return "%d of %d" % (sum(c["outcome"] in ("ejected", "diverged") for c in cells), len(cells))


def main():
    models = read(sys.argv[1])
    fastest = max(c["largest_speed_m_s"] for c in models["implicit"])
    for model, cells in models.items():
        several = [c for c in cells if c["contacts"] >= 2]
        within = [c for c in several if not beyond_springs(c)]
        print("%s, %d cells: %s" % (model, len(cells), ", ".join(
            "%s %.1f %%" % (o, 100.0 * sum(c["outcome"] == o for c in cells) / len(cells)) for o in OUTCOMES)))
        print("  grips held: %s" % stable([c for c in cells if is_grip(c)]))
        print("  stable, but faster than any of implicit (%.2f m/s): %d" % (
            fastest, sum(c["outcome"] == "stable" and c["largest_speed_m_s"] > fastest for c in cells)))
        for name, beyond in (("springs", beyond_springs), ("dampers", beyond_dampers)):
            print("  stable beyond the bound of the %s: %s; within: %s" % (
                name, stable([c for c in several if beyond(c)]), stable([c for c in several if not beyond(c)])))
        print("  ejected or diverged within the springs' bound where a kick is below 0.5 m/s: %s; above 1 m/s: %s" % (
            thrown([c for c in within if kick(c) < 0.5]), thrown([c for c in within if kick(c) > 1.0])))
        print("  by a single fingertip: %s" % thrown([c for c in cells if c["contacts"] == 1]))


if __name__ == "__main__":
    main()
