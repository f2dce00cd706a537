"""Counts the steps that learners need in discrete environments of Gymnasium.

pip install "./python[sklearn]" minigrid "gymnasium[toy-text]"
python assets/results/python-learners/learning.py                 # writes learning.json; started again, it goes on
python assets/results/python-learners/learning.py --table         # prints its tables

`--methods "q-learning 0.5 0.1"` is Q-learning with this learning rate and share of random actions.

A greedy policy is tested every so many steps, in episodes of its own. A run ends when two tests in a row reach the best
return less a tenth of its absolute value; the first of them counts. A run that does not is one that failed.
"""

import argparse
import json
import statistics
import time
from pathlib import Path

import numpy

FILE = Path(__file__).with_name("learning.json")
TEST_SEED = 1_000_000
# By environment: steps, steps between two tests, episodes of a test.
BUDGETS = {
    "FrozenLake-v1 8x8": (100_000, 2_000, 200),
    "Taxi-v4": (100_000, 2_000, 50),
    "CliffWalking-v1": (30_000, 250, 1),
    "MiniGrid-Empty-6x6": (20_000, 500, 1),
    "MiniGrid-DoorKey-5x5": (40_000, 4_000, 20),
    "MiniGrid-FourRooms": (40_000, 8_000, 20),
}
RUNS = 30
GAMMA = 0.99


class QLearning:
    """Q-learning in a table, with random actions in a tenth of the steps."""

    def __init__(self, actions, seed, rate=0.2, explore=0.1):
        self.actions, self.rate, self.explore = actions, rate, explore
        self.rng = numpy.random.default_rng(seed)
        self.table = {}

    def row(self, percept):
        return self.table.setdefault(percept.tobytes(), numpy.zeros(self.actions))

    def act(self, percept):
        row = self.row(percept)
        if self.rng.random() < self.explore:
            return int(self.rng.integers(self.actions))
        return int(self.rng.choice(numpy.flatnonzero(row == row.max())))

    def learn(self, percept, action, reward, after, terminated):
        target = reward if terminated else reward + GAMMA * self.row(after).max()
        row = self.row(percept)
        row[action] += self.rate * (target - row[action])

    def end(self):
        pass

    def policy(self, percept):
        row = self.table.get(percept.tobytes())
        return int(self.rng.integers(self.actions)) if row is None else int(row.argmax())

    def rules(self):
        return len(self.table) * self.actions


class Ours:
    """A learner of the package."""

    def __init__(self, learner, actions, seed):
        self.learner, self.actions = learner, actions
        self.rng = numpy.random.default_rng(seed)

    def act(self, percept):
        return self.learner.act(percept)

    def learn(self, percept, action, reward, after, terminated):
        self.learner.update(reward, after, terminated)

    def end(self):
        self.learner.end_episode()

    def policy(self, percept):
        values = self.learner.values(percept)
        known = [value for value in values if value is not None]
        if not known:
            return int(self.rng.integers(self.actions))
        return values.index(max(known))

    def rules(self):
        return self.learner.n_rules


def xcs(env, seed):
    import xcscr

    return xcscr.XCS.for_env(env, seed=seed)


def create(method, env, seed):
    actions = int(env.action_space.n)
    name, *settings = method.split(" ")
    if name == "q-learning":
        return QLearning(actions, seed, *map(float, settings))
    return Ours({"xcs": xcs}[method](env, seed), actions, seed)


def tested(agent, env, episodes):
    """Returns the mean return of the greedy policy."""
    total = 0.0
    for episode in range(episodes):
        percept, _ = env.reset(seed=TEST_SEED + episode)
        done = False
        while not done:
            percept, reward, terminated, truncated, _ = env.step(agent.policy(percept))
            done, total = terminated or truncated, total + float(reward)
    return total / episodes


def run(method, problem, seed):
    """Returns a row of the results."""
    from problems import MAKE, best_return

    steps, between, episodes = BUDGETS[problem]
    env, tests = MAKE[problem](), MAKE[problem]()
    best = best_return(tests, range(TEST_SEED, TEST_SEED + episodes))
    enough = best - 0.1 * abs(best)
    agent = create(method, env, seed)
    met, returns, reached, spent = {}, [], None, 0.0
    percept, _ = env.reset(seed=seed)
    step = 0
    while step < steps:
        begin = time.process_time()
        for _ in range(between):
            met[percept.tobytes()] = percept
            action = agent.act(percept)
            after, reward, terminated, truncated, _ = env.step(action)
            agent.learn(percept, action, float(reward), after, terminated)
            percept = after
            if terminated or truncated:
                agent.end()
                percept, _ = env.reset()
        step += between
        spent += time.process_time() - begin
        returns.append(tested(agent, tests, episodes))
        if returns[-1] >= enough:
            if reached is not None:
                break
            reached = step
        else:
            reached = None
    row = {"method": method, "problem": problem, "seed": seed, "best": best, "steps": reached, "last": returns[-1]}
    row |= {"greatest": max(returns), "cpu_s": round(spent, 2), "rules": agent.rules(), "percepts": len(met)}
    return row


def read(file):
    return json.loads(file.read_text()) if file.exists() else []


def write(file, rows):
    """Replaces a file of rows, so that it is whole at any time."""
    part = file.with_suffix(".part")
    part.write_text("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n")
    part.replace(file)


def table(rows):
    print("| environment | learner | runs | reached | steps, median | quartiles | return / best | CPU s | rules |")
    print("|---|---|---|---|---|---|---|---|---|")
    for problem in BUDGETS:
        for method in sorted({row["method"] for row in rows}):
            own = [row for row in rows if (row["problem"], row["method"]) == (problem, method)]
            if not own:
                continue
            middle = lambda key: statistics.median(row[key] for row in own)
            steps = sorted(row["steps"] or float("inf") for row in own)
            at = [steps[round(share * (len(steps) - 1))] for share in (0.25, 0.5, 0.75)]
            low, median, high = ("-" if one == float("inf") else f"{one:,.0f}" for one in at)
            reached = sum(row["steps"] is not None for row in own)
            rules = f"{middle('rules'):,.0f}" if method != "ppo" else "-"
            print(
                f"| {problem} | {method} | {len(own)} | {reached} | {median} | {low} to {high} "
                f"| {middle('last'):.2f} / {own[0]['best']:.2f} | {middle('cpu_s'):.1f} | {rules} |"
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--table", action="store_true", help="print the tables of the results so far")
    parser.add_argument("--only", nargs="*", default=list(BUDGETS), help="these environments")
    parser.add_argument("--methods", nargs="*", default=["xcs", "q-learning"])
    parser.add_argument("--runs", type=int, default=RUNS, help="the runs of each")
    parser.add_argument("--first", type=int, default=1, help="the seed of the first run")
    parser.add_argument("--file", type=Path, default=FILE, help="results, to which rows are added")
    given = parser.parse_args()
    rows = read(given.file)
    if given.table:
        return table(rows)
    done = {(row["method"], row["problem"], row["seed"]) for row in rows}
    for seed in range(given.first, given.first + given.runs):
        for problem in given.only:
            for method in given.methods:
                if (method, problem, seed) not in done:
                    rows.append(run(method, problem, seed))
                    print(rows[-1], flush=True)
                    write(given.file, rows)


if __name__ == "__main__":
    main()
