"""Compares XCSClassifier, its compacted rules and a decision tree on five tables.

pip install "./python[sklearn]"
python assets/results/python-learners/classifiers.py            # adds runs to classifiers.json; started again, it goes on
python assets/results/python-learners/classifiers.py --table    # prints the table

A run is one of three stratified folds. `s0=1` is the spread of covering that the package had as default.
"""

import statistics
import sys
import time
from pathlib import Path

from learning import read, write
from sklearn.datasets import load_breast_cancer, load_digits, load_iris, load_wine, make_classification
from sklearn.model_selection import StratifiedKFold
from sklearn.tree import DecisionTreeClassifier
from xcscr import XCSClassifier

FILE = Path(__file__).with_name("classifiers.json")
TABLES = {
    "iris": lambda: load_iris(return_X_y=True),
    "wine": lambda: load_wine(return_X_y=True),
    "breast cancer": lambda: load_breast_cancer(return_X_y=True),
    "digits": lambda: load_digits(return_X_y=True),
    "synthetic": lambda: make_classification(3000, 20, n_informative=5, n_redundant=5, n_classes=3, random_state=0),
}
METHODS = ["tree", "XCSClassifier(s0=1)", "XCSClassifier()", "its compact()"]


def runs(table, fold):
    """Yields a row for each method."""
    X, y = TABLES[table]()
    train, test = list(StratifiedKFold(3, shuffle=True, random_state=1).split(X, y))[fold]

    def row(method, learn, count):
        begin = time.process_time()
        model = learn()
        spent = time.process_time() - begin
        figures = {"accuracy": model.score(X[test], y[test]), "rules": count(model), "cpu_s": round(spent, 3)}
        return model, {"table": table, "method": method, "fold": fold} | figures

    rules = lambda model: len(model.rules())
    fit = lambda model: lambda: model.fit(X[train], y[train])
    yield row("tree", fit(DecisionTreeClassifier(random_state=1)), lambda model: int(model.get_n_leaves()))[1]
    yield row("XCSClassifier(s0=1)", fit(XCSClassifier(s0=1.0)), rules)[1]
    model, figures = row("XCSClassifier()", fit(XCSClassifier()), rules)
    yield figures
    yield row("its compact()", lambda: model.compact(X[train], y[train]), rules)[1]


def table(rows):
    print("| table | method | folds | accuracy | rules or leaves | CPU s |\n|---|---|---|---|---|---|")
    for name in TABLES:
        for method in METHODS:
            own = [row for row in rows if (row["table"], row["method"]) == (name, method)]
            if own:
                accuracy, count, seconds = (statistics.mean(row[key] for row in own) for key in ("accuracy", "rules", "cpu_s"))
                print(f"| {name} | {method} | {len(own)} | {accuracy:.3f} | {count:.0f} | {seconds:.2f} |")


def main():
    rows = read(FILE)
    if "--table" in sys.argv:
        return table(rows)
    for fold in range(3):
        for name in TABLES:
            if not any((row["table"], row["fold"]) == (name, fold) for row in rows):
                rows += runs(name, fold)
                write(FILE, rows)
                print(rows[-4:], flush=True)


if __name__ == "__main__":
    main()
