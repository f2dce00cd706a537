"""The experiments of a paper: five methods in four worlds, with 30 seeds each, in tables and a figure.

    pip install "./python[pandas]" matplotlib
    python examples/compare_methods.py [trials, 30 by default] [folder, comparison by default]

The folder gets the report of the study, `profile.svg` and `table.md`. Started again, the study goes on.
"""

import sys
from pathlib import Path

import matplotlib
import numpy as np
import xcscr

sys.path.append(str(Path(__file__).parents[1] / "assets/results"))
import aggregate


class Optimist:
    """Q-learning that begins with high values, so that it tries every action without exploring at random."""

    def __init__(self, n_actions, n_bits, seed):
        self.n_actions, self.table = n_actions, {}

    def values(self, percept):
        return self.table.get(percept, [1000.0] * self.n_actions)

    def choose(self, percept):
        return int(np.argmax(self.values(percept)))

    def learn(self, percept, action, reward, next_percept):
        row = self.table.setdefault(percept, [1000.0] * self.n_actions)
        best = 0.0 if next_percept is None else max(self.values(next_percept))
        row[action] += 0.2 * (reward + 0.95 * best - row[action])

    def end_episode(self, reached_goal):
        pass


trials = int(sys.argv[1]) if len(sys.argv) > 1 else 30
out = Path(sys.argv[2] if len(sys.argv) > 2 else "comparison")
methods = ["xcscr", "xcscr-plus", Optimist, "q-learning", "dyna-q"]
study = xcscr.study(["maze4", "maze5", "maze6", "rooms-8-1"], methods, trials=trials, reference=Optimist, out=out)
print(study.report())

# By method and world, for each trial the share of episodes after which the policy was optimal. This repeats the trials.
scores = {name: [list(world) for world in runs.T] for name, runs in study.scores().items()}
lines = ["| method | IQM | 95 % interval | P(optimist is better) |", "|---|---|---|---|"]
for name, own in scores.items():
    value, low, high = aggregate.bootstrap(aggregate.iqm, own)
    better = aggregate.bootstrap(aggregate.improvement, scores["optimist"], own)[0]
    lines.append(f"| {name} | {value:.3f} | {low:.3f} to {high:.3f} | {'' if name == 'optimist' else f'{better:.2f}'} |")
(out / "table.md").write_text("\n".join(lines) + "\n")
print("\n".join(lines))

matplotlib.use("svg")
from matplotlib import pyplot

for name, own in scores.items():
    all_scores = np.sort(np.concatenate(own))
    pyplot.step(all_scores, 1 - np.arange(len(all_scores)) / len(all_scores), where="post", label=name)
pyplot.xlabel("share of episodes after which the policy is optimal")
pyplot.ylabel("share of trials with at least this share")
pyplot.legend()
pyplot.savefig(out / "profile.svg")
