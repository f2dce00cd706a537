#!/usr/bin/env python3
"""Writes the tables of docs/src/results/ from the summaries in this folder.

    python3 assets/results/tables.py            # rewrite the tables
    python3 assets/results/tables.py --check    # fail if a table differs from the summaries

A table stands between `<!-- table: NAME -->` and `<!-- end -->` and is made by the function of that name below.
"""

import json
import re
import sys
from pathlib import Path
from statistics import mean, stdev

import ablation
import aggregate

HERE = Path(__file__).resolve().parent
PAGES = HERE.parent.parent / "docs" / "src" / "results"

PAPER = {  # solved trials of 100 in Maze4, Maze5, Maze6 (Zhang, Browne and Carnegie 2019)
    "xcs": [7, 2, 0],
    "adapted-even": [77, 29, 25],
    "adapted-discounted": [77, 29, 25],
    "xcscr": [79, 54, 65],
}
MAZES = {"maze4": "Maze4", "maze5": "Maze5", "maze6": "Maze6", "maze5-wet": "Maze5, slippery"}
GROUPS = {
    "not aliased": "cassandra4x4 maze4-classic maze5-classic mazea mazef1 mazef2 mazef3 woods1-walled woods14",
    "group I": "littman57 littman89 mazeb mazed miyazakia",
    "group II": "mazee1 mazee2 woods100 woods101 woods101demi woods102",
    "group III": "lab1 maze10 maze7 mazee3 mazef4 mazef8 mazef9 miyazakib sutton",
}
BEACS = {  # mean steps after 1,000 episodes, one trial
    "littman57": 5.85,
    "mazee1": 6.91,
    "mazee2": 6.62,
    "woods100": 2.31,
    "woods101": 3.05,
    "woods102": 4.02,
    "maze10": 5.96,
    "maze7": 4.34,
    "mazef4": 4.43,
}
GROUPS = {name: worlds.split() for name, worlds in GROUPS.items()}


def arms(study):
    return json.loads((HERE / f"{study}.json").read_text())["arms"]


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]


def percent(share):
    return "–" if share is None else f"{100 * share:.0f} %"


def interval(arm):
    return f"{100 * arm['wilson_low']:.0f} to {100 * arm['wilson_high']:.0f}"


def steps_interval(arm):
    return f"{arm['iqm_env_steps_low']:.0f} to {arm['iqm_env_steps_high']:.0f}"


def shown(arm):
    """The median number of the fewest rules of retained trials; a dash without rules or such trials."""
    median = arm["median_compacted_rules"]
    return "–" if median is None else f"{median:g}"


def or_dash(value):
    return "–" if value is None else value


def paper():
    head = ["method", "maze", "solved", "95 % interval", "retained at the end", "stays optimal", "solved in the paper"]
    rows = []
    for method, published in PAPER.items():
        own = [arm for arm in arms("paper") if arm["method"] == method]
        for arm, number in zip(own, published):
            share = percent(arm["mean_optimal_share_after_first"])
            rows.append([f"`{method}`", MAZES[arm["world"]], arm["successes"], interval(arm), arm["retained"], share, number])
    return table(head, rows)


def defaults():
    head = ["method", "maze", "solved", "95 % interval", "retained at the end", "median first optimal episode", "steps until solved", "95 % interval", "rules", "rules shown"]
    rows = []
    for name, own in [("defaults", None), ("r-max-bare", "`r-max` without generalisation")]:
        for arm in sorted(arms(name), key=lambda arm: arm["world"]):
            label = own or f"`{arm['method']}`"
            rows.append([label, MAZES[arm["world"]], arm["successes"], interval(arm), arm["retained"], or_dash(arm["median_episode"]), f"{arm['iqm_env_steps']:.0f}", steps_interval(arm), f"{arm['mean_rules']:.0f}", shown(arm)])
    order = list(dict.fromkeys(row[0] for row in rows))
    return table(head, sorted(rows, key=lambda row: order.index(row[0])))


def parts():
    head = ["left out", "maze", "solved", "retained at the end", "steps until solved", "95 % interval", "collisions", "rules shown"]
    rows = []
    for arm in sorted(arms("parts"), key=lambda arm: arm["world"]):
        part = arm["variant"].removeprefix("without=")
        part = part if part == "nothing" else f"`{part}`"
        rows.append([part, MAZES[arm["world"]], arm["successes"], arm["retained"], f"{arm['iqm_env_steps']:.0f}", steps_interval(arm), f"{arm['mean_collisions']:.0f}", shown(arm)])
    return table(head, rows)


def mechanisms():
    head = ["left out", "maze", "solved", "retained at the end", "steps until solved", "95 % interval", "contacts", "rules shown"]
    rows = []
    for arm in arms("mechanisms"):
        part = arm["variant"].removeprefix("without=")
        part = part if part == "nothing" else f"`{part}`"
        rows.append([part, MAZES[arm["world"]], arm["successes"], arm["retained"], f"{arm['iqm_env_steps']:.0f}", steps_interval(arm), f"{arm['mean_collisions']:.0f}", shown(arm)])
    return table(head, rows)


MECHANISMS = ["short_term_filter", "learning_rate_switching", "imprinting", "learning_step_threshold"]


def mechanisms_paper():
    """By mechanism, what it adds on average over all combinations of the others, and if it is added last."""
    head = ["mechanism", "maze", "solved, on average", "solved, added last", "retained, on average", "retained, added last"]
    rows = []
    for mechanism in MECHANISMS:
        others = [f"reward.{other}=true" for other in MECHANISMS if other != mechanism]
        for world in ["maze4", "maze5", "maze6"]:
            own = [arm for arm in arms("mechanisms-paper") if arm["world"] == world]
            row = [f"`reward.{mechanism}`", MAZES[world]]
            for key in ["successes", "retained"]:
                sides = [[arm for arm in own if f"reward.{mechanism}={on}" in arm["variant"]] for on in ["true", "false"]]
                average = [mean(arm[key] for arm in side) for side in sides]
                last = [next(arm[key] for arm in side if all(other in arm["variant"] for other in others)) for side in sides]
                row += [f"{average[0] - average[1]:+.1f}", f"{last[0] - last[1]:+d}"]
            rows.append(row)
    return table(head, rows)


def readings():
    head = ["young rules", "the switched rate drives", "maze", "solved", "retained at the end", "steps until solved", "95 % interval"]
    rows = []
    for arm in arms("readings"):
        mean, scope = (part.split("=")[1] for part in arm["variant"].split(" "))
        young = "means" if mean == "true" else "beta from the start"
        drives = "all statistics" if scope == "all" else "the prediction"
        rows.append([young, drives, MAZES[arm["world"]], arm["successes"], arm["retained"], f"{arm['iqm_env_steps']:.0f}", steps_interval(arm)])
    return table(head, rows)


def of_group(study, method, worlds, variant=None):
    return [arm for arm in arms(study) if arm["method"] == method and arm["world"] in worlds and variant in (None, arm["variant"])]


def history():
    bounds = json.loads((HERE / "bounds.json").read_text())
    head = ["mazes", "number", "unknown-start optimum", "earlier steps", "steps after 100 episodes", "worst maze", "mazes at the optimum", "rules"]
    rows = []
    for group, worlds in GROUPS.items():
        unknown = mean(bounds[world]["belief"]["steps"] for world in worlds)
        for steps in range(2):
            own = of_group("history", "xcscr-plus", worlds, f"sensor.history={steps}")
            ratios = [arm["mean_greedy_steps"] / bounds[arm["world"]]["belief"]["steps"] for arm in own]
            found = sum(ratio < 1.005 for ratio in ratios)
            rows.append([group, len(worlds), f"{unknown:.2f}", steps, f"{mean(arm['mean_greedy_steps'] for arm in own):.2f}", f"{max(ratios):.2f}", found, f"{mean(arm['mean_rules'] for arm in own):.0f}"])
    return table(head, rows)


def beacs():
    bounds = json.loads((HERE / "bounds.json").read_text())
    head = ["maze", "unknown-start optimum", "no earlier step", "one", "BEACS"]
    rows = []
    for world, published in BEACS.items():
        means = [of_group("history", "xcscr-plus", [world], f"sensor.history={steps}") for steps in range(2)]
        rows.append([f"`{world}`", f"{bounds[world]['belief']['steps']:.2f}"] + [f"{arm[0]['mean_greedy_steps']:.2f}" for arm in means] + [published])
    return table(head, rows)


def office():
    conditions = {"noise2": "noise 2", "noise3": "noise 3", "encoder": "stuck encoder", "sector": "dead sector 90 deg"}
    seeds = json.loads((HERE / "office.json").read_text())
    rows = []
    for name, words in conditions.items():
        own = [seed[name] for seed in seeds.values()]
        rows.append([words, len(own), f"{mean(own):.1f} %", f"{stdev(own):.1f}", f"{min(own)} %"])
    return table(["condition", "seeds", "mean of the policies", "standard deviation", "worst policy"], rows)


def slips():
    head = ["method", "steps", "best maze", "worst maze", "globally optimal", "trials", "rules or pairs"]
    rows = []
    for method in ["q-learning", "xcscr", "r-max", "xcscr-plus"]:
        own = of_group("slips", method, GROUPS["not aliased"])
        steps = [arm["mean_greedy_steps"] for arm in own]
        rows.append([f"`{method}`", f"{mean(steps):.2f}", f"{min(steps):.2f}", f"{max(steps):.2f}", sum(arm["retained"] for arm in own), sum(arm["trials"] for arm in own), f"{mean(arm['mean_rules'] for arm in own):.0f}"])
    return table(head, rows)


def sensed(study):
    head = ["maze", "method", "solved", "95 % interval", "retained at the end", "steps until solved", "95 % interval"]
    rows = []
    for arm in arms(study):
        rows.append([MAZES[arm["world"]], f"`{arm['method']}`", arm["successes"], interval(arm), arm["retained"], f"{arm['iqm_env_steps']:.0f}", steps_interval(arm)])
    return table(head, rows)


def lidar():
    return sensed("lidar")


def lidar_noisy():
    return sensed("lidar-noisy")


def generated():
    head = ["kind", "cells", "worlds", "solved", "retained at the end", "latest first optimal episode"]
    groups = {}
    for arm in arms("generated"):
        kind, size, _ = arm["world"].rsplit("-", 2)
        groups.setdefault((kind, size), []).append(arm)
    rows = []
    for (kind, size), own in groups.items():
        latest = max((arm["median_episode"] or 0 for arm in own), default=0)
        rows.append([f"`{kind}`", f"{size} x {size}", len(own), sum(arm["successes"] for arm in own), sum(arm["retained"] for arm in own), latest])
    return table(head, rows)


def large():
    head = ["world", "method", "trials", "solved", "steps until solved", "rules of [P] or pairs"]
    return table(head, [[f"`{arm['world']}`", f"`{arm['method']}`", arm["trials"], arm["successes"], f"{arm['iqm_env_steps']:.0f}", f"{arm['mean_rules']:.0f}"] for arm in arms("large")])


MARKED = re.compile(r"(<!-- table: ([\w-]+) -->\n).*?(<!-- end -->)", re.S)


def filled(text):
    def fill(match):
        rows = globals()[match[2].replace("-", "_")]()
        return match[1] + "\n".join(rows) + "\n" + match[3]

    return MARKED.sub(fill, text)


def main():
    ablation.check()
    aggregate.check()
    stale = []
    for page in sorted(PAGES.glob("*.md")):
        before = page.read_text()
        after = filled(before)
        if before != after:
            stale.append(page.name)
            if "--check" not in sys.argv:
                page.write_text(after)
    if "--check" in sys.argv and stale:
        sys.exit(f"run `python3 assets/results/tables.py`: the tables of {', '.join(stale)} differ from the summaries")


main()
