#!/usr/bin/env python3
"""Compares the size of the rules of xcscr-plus with that of decision trees for the same decisions.

Usage: cart.py XCSCR WORLD... [--trials N] [--dtcontrol PROGRAM]     needs scikit-learn

For each world and seed, xcscr-plus learns on the grid with the percept as its state. The decisions of the fewest rules
that `xcscr rules` prints, in all cells, are then given to scikit-learn. Of equally good actions the tree may use any:
each of 100 fits draws one at random, and the tree with the fewest leaves counts. Values that differ by a thousandth are
equally good, as for `xcscr rules`. A rule's conditions are its bits that are not "don't care"; a tree's
conditions are the tests on the paths to all of its leaves. dtControl gets all equally good actions of each percept and
determinises by itself; its presets `maxfreq` and `mlentropy` are run, and the tree with the fewest leaves counts.
"""

import argparse
import json
import random
import statistics
import subprocess
import tempfile
from pathlib import Path

from sklearn.tree import DecisionTreeClassifier

FITS = 100
# Values that differ by less than this share are equally good.
NEARLY = 1e-3
PRESETS = ["maxfreq", "mlentropy"]
# Column and row, clockwise from north.
AROUND = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)]


def percepts(world):
    """Returns the percept `neighbours` of each free cell that is no goal, without repetition."""
    rows = json.loads(Path(world).read_text())["rows"]

    def bits(column, row):
        cell = rows[row][column]
        return {"#": "01", "G": "11"}.get(cell, "00")

    found = {
        "".join(bits(column + x, row + y) for x, y in AROUND)
        for row, line in enumerate(rows)
        for column, cell in enumerate(line)
        if cell not in "#G"
    }
    return sorted(found)


def best_actions(rules, percept):
    """Returns the actions of nearly the greatest fitness-weighted prediction; none where no rule matches."""
    sums = {}
    for rule in rules:
        if all(c in ("#", bit) for c, bit in zip(rule["condition"], percept)):
            weighed, fitness = sums.get(rule["action"], (0.0, 0.0))
            sums[rule["action"]] = (weighed + rule["prediction"] * rule["fitness"], fitness + rule["fitness"])
    values = {action: weighed / fitness for action, (weighed, fitness) in sums.items()}
    greatest = max(values.values(), default=0)
    return [action for action, value in values.items() if value >= greatest - NEARLY * abs(greatest)]


def smallest_tree(decisions, seed):
    """Returns leaves and conditions of the smallest tree of many fits."""
    chance = random.Random(seed)
    inputs = [[int(bit) for bit in percept] for percept, _ in decisions]
    sizes = []
    for fit in range(FITS):
        labels = [chance.choice(actions) for _, actions in decisions]
        tree = DecisionTreeClassifier(random_state=fit).fit(inputs, labels)
        paths = tree.decision_path(inputs).sum(axis=1).A1 - 1
        by_leaf = dict(zip(tree.apply(inputs), paths))
        sizes.append((tree.get_n_leaves(), int(sum(by_leaf.values()))))
    return min(sizes)


def paths_of(tree, depth=0):
    """Yields the length of the path to each leaf of a tree of dtControl."""
    if not tree["children"]:
        yield depth
    for child in tree["children"]:
        yield from paths_of(child, depth + 1)


def smallest_of_dtcontrol(program, decisions):
    """Returns leaves and tests of dtControl's smallest tree."""
    with tempfile.TemporaryDirectory() as folder:
        rows = [[*percept, str(action)] for percept, actions in decisions for action in actions]
        lines = ["#PERMISSIVE", f"#BEGIN {len(decisions[0][0])} 1", *map(",".join, rows)]
        Path(folder, "policy.csv").write_text("\n".join(lines) + "\n")
        command = [program, "-i", "policy.csv", "-p", *PRESETS, "-o", "out"]
        subprocess.run(command, check=True, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        files = [Path(folder, "out", preset, "policy", f"{preset}.json") for preset in PRESETS]
        trees = [list(paths_of(json.loads(file.read_text()))) for file in files]
        return min((len(paths), sum(paths)) for paths in trees)


def compare(xcscr, world, seed, dtcontrol):
    with tempfile.TemporaryDirectory() as folder:
        what = ["--arena", "grid", "--sensor", "neighbours", "--record", "none", "--quiet"]
        command = [xcscr, "train", world, *what, "--seed", str(seed), "--out", f"{folder}/run"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        printed = subprocess.run([xcscr, "rules", f"{folder}/run", "--json"], check=True, capture_output=True)
        rules = json.loads(printed.stdout)["percept-rules"]["rules"]
    decided = [(percept, best_actions(rules, percept)) for percept in percepts(world)]
    decisions = [one for one in decided if one[1]]
    conditions = sum(16 - rule["condition"].count("#") for rule in rules)
    sizes = (len(decisions), len(rules), conditions, *smallest_tree(decisions, seed))
    return sizes + (smallest_of_dtcontrol(dtcontrol, decisions) if dtcontrol else ())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("xcscr")
    parser.add_argument("worlds", nargs="+")
    parser.add_argument("--trials", type=int, default=10)
    parser.add_argument("--dtcontrol")
    args = parser.parse_args()
    head = "| world | percepts | rules | tests of rules | leaves of CART | tests of CART |"
    if args.dtcontrol:
        head += " leaves of dtControl | tests of dtControl |"
    print(f"{head}\n{'|---' * (head.count('|') - 1)}|")
    for world in args.worlds:
        sizes = [compare(args.xcscr, world, seed, args.dtcontrol) for seed in range(1, args.trials + 1)]
        medians = [f"{statistics.median(column):g}" for column in zip(*sizes)]
        print(f"| `{Path(world).stem}` | {' | '.join(medians)} |")


if __name__ == "__main__":
    main()
