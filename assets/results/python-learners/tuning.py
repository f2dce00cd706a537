"""Compares the defaults of xcscr.XCS with each of them changed, and with earlier defaults.

pip install "./python[sklearn]" minigrid "gymnasium[toy-text]"
python assets/results/python-learners/tuning.py 1001 1006       # the seeds from the first to before the last

A run counts as solved when the greedy policy is optimal in two tests in a row, 500 steps apart, within 15,000 steps.
Seeds and problems of learning.py are others.
"""

import statistics
import sys

import gymnasium
import xcscr
from problems import toy

EARLIER = {"gamma": 0.71, "p_explore": 0.5, "p_hash": 0.3, "theta_ga": 25, "theta_sub": 20, "epsilon_0": 10.0}
#: By problem: how to make it, its best return, and its largest absolute reward.
PROBLEMS = {
    "FrozenLake 4x4": (lambda: toy("FrozenLake-v1", (4, 4), ["row", "column"], map_name="4x4", is_slippery=False), 1.0, 1.0),
    "CliffWalking": (lambda: toy("CliffWalking-v1", (4, 12), ["row", "column"]), -13.0, 100.0),
    "Maze4": (lambda: gymnasium.make("xcscr/Maze4-v0", arena="grid", step_reward=-0.02, disable_env_checker=True), 0.82, 1.0),
}
CHANGES = {
    "defaults": {},
    "earlier defaults": EARLIER,
    "gamma 0.71": {"gamma": 0.71},
    "p_explore 0.5": {"p_explore": 0.5},
    "p_hash 0.3": {"p_hash": 0.3},
    "theta_ga 25, theta_sub 20": {"theta_ga": 25, "theta_sub": 20},
    "epsilon_0 1 % of the reward": {"epsilon_0": 0.01},
}


def greedy_return(learner, env):
    observation, _ = env.reset(seed=1)
    total, done = 0.0, False
    while not done:
        observation, reward, terminated, truncated, _ = env.step(learner.policy(observation))
        total, done = total + float(reward), terminated or truncated
    return total


def steps_needed(problem, seed, given):
    """Returns the steps before the first of two optimal tests in a row, or infinity."""
    make, best, largest = PROBLEMS[problem]
    if "epsilon_0" in given and given is not EARLIER:
        given = given | {"epsilon_0": given["epsilon_0"] * largest}
    env, tests = make(), make()
    learner = xcscr.XCS.for_env(env, seed=seed, **given)
    observation, _ = env.reset(seed=seed)
    was_best = False
    for step in range(1, 15_001):
        observation, reward, terminated, truncated, _ = env.step(learner.act(observation))
        learner.update(float(reward), observation, terminated)
        if terminated or truncated:
            learner.end_episode()
            observation, _ = env.reset()
        if step % 500 == 0:
            is_best = greedy_return(learner, tests) >= best - 1e-6
            if is_best and was_best:
                return step - 500
            was_best = is_best
    return float("inf")


def main():
    seeds = range(int(sys.argv[1]), int(sys.argv[2]))
    print("| settings | " + " | ".join(f"{problem}: solved | median steps" for problem in PROBLEMS) + " |")
    print("|---|" + "---|---|" * len(PROBLEMS))
    for name, given in CHANGES.items():
        cells = []
        for problem in PROBLEMS:
            steps = [steps_needed(problem, seed, given) for seed in seeds]
            middle = statistics.median(steps)
            cells.append(f"{sum(one < float('inf') for one in steps)} of {len(steps)}")
            cells.append("-" if middle == float("inf") else f"{middle:,.0f}")
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
