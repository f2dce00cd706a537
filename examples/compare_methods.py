"""The experiments of a paper: five methods in four worlds, with 30 seeds each, in tables and figures.

    pip install "./python[pandas]" matplotlib
    python examples/compare_methods.py [trials, 30 by default] [folder, comparison by default]

Prints the report and aggregates. The folder also gets `table.tex` and `figures.svg`. Started again, the study goes on.
All methods have their defaults and the same number of episodes, but not of steps. The defaults of xcscr were searched in
Maze4 to Maze6, so only rooms-8-1 is new to it, and xcscr-plus knows how moves in mazes work. The others were not searched.
"""

import sys
from pathlib import Path

import numpy as np
import xcscr
from matplotlib import pyplot

sys.path.append(str(Path(__file__).parents[1] / "assets/results"))
from aggregate import bootstrap, iqm


class Optimist:
    """Q-learning with the learning rate 1 that begins with high values, and always takes one of the best actions."""

    def __init__(self, n_actions, n_bits, seed):
        self.start, self.table, self.rng = np.full(n_actions, 1000.0), {}, np.random.default_rng(seed)

    def values(self, percept):
        return self.table.get(percept, self.start)

    def choose(self, percept):
        return int(self.rng.choice(np.flatnonzero(self.values(percept) == self.values(percept).max())))

    def learn(self, percept, action, reward, next_percept):
        best = 0.0 if next_percept is None else self.values(next_percept).max()
        self.table.setdefault(percept, self.start.copy())[action] = reward + 0.95 * best

    def end_episode(self, reached_goal):
        pass


trials, out = int((sys.argv[1:] or ["30"])[0]), Path((sys.argv[2:] or ["comparison"])[0])
worlds, methods = ["maze4", "maze5", "maze6", "rooms-8-1"], ["xcscr", "xcscr-plus", Optimist, "q-learning", "dyna-q"]
progress = lambda done, of: print(f"\r{done} of {of}", end="", file=sys.stderr)
study = xcscr.study(worlds, methods, trials=trials, reference=Optimist, out=out, progress=progress)
print(study.report())
columns = ["world", "method", "successes", "retained", "iqm_env_steps", "iqm_env_steps_low", "iqm_env_steps_high"]
study.summary()[columns].to_latex(out / "table.tex", index=False, escape=True, float_format="%.0f")
# The score of a trial is the share of episodes after which its policy was optimal. This repeats the trials.
scores = {name: list(runs.T) for name, runs in study.scores().items()}
difference = lambda ours, theirs: iqm(ours) - iqm(theirs)
_, (profile, *panels) = pyplot.subplots(1, 5, figsize=(20, 4), sharey=True)
for name, own in scores.items():
    print(name + ": IQM %.3f [%.3f, %.3f]" % bootstrap(iqm, own))
    if name != "optimist":  # The 95 % intervals of the differences are corrected for their number.
        compared = bootstrap(difference, scores["optimist"], own, comparisons=len(scores) - 1)
        print("  IQM of optimist less that of " + name + ": %+.3f [%+.3f, %+.3f]" % compared)
    profile.ecdf(np.concatenate(own), complementary=True, label=name)
profile.set(title="performance profile", xlabel="score", ylabel="share of trials")
profile.legend()
for (world, name), curve in study.curves().groupby(["world", "method"], sort=False):
    panel = panels[worlds.index(world)]
    panel.semilogx(curve["steps"], curve["optimal"])
    panel.fill_between(curve["steps"], curve["low"], curve["high"], alpha=0.2)
    panel.set(title=f"{world}: policy optimal", xlabel="environment steps")
pyplot.savefig(out / "figures.svg")
