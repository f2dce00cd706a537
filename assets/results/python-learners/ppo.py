"""Adds PPO of rejax to learning.json, for the environments that are tables of transitions.

pip install rejax==0.1.3 "gymnasium[toy-text]" minigrid
python assets/results/python-learners/ppo.py        # started again, it goes on with the next environment

rejax needs environments in JAX. The tables of Gymnasium's toy environments are copied into arrays. All seeds train at
once. The percepts are those of the other learners, as bits.
"""

import argparse
import time
from pathlib import Path

import jax
import numpy
from flax import struct
from gymnax.environments import spaces
from jax import numpy as jnp
from learning import BUDGETS, FILE, GAMMA, RUNS, read, write
from problems import MAKE, STEP_LIMIT, best_return
from rejax import PPO

LANES, STEPS = 8, 64


@struct.dataclass
class State:
    at: int
    time: int


@struct.dataclass
class Params:
    max_steps_in_episode: int = STEP_LIMIT


class Table:
    """An environment of Gymnasium with a table of transitions, in JAX."""

    default_params = Params()

    def __init__(self, env):
        table, states, actions = env.unwrapped.P, len(env.unwrapped.P), int(env.action_space.n)
        most = max(len(table[state][action]) for state in table for action in table[state])
        shares, after, rewards, ends = (numpy.zeros((states, actions, most)) for _ in range(4))
        for state, action in numpy.ndindex(states, actions):
            for at, outcome in enumerate(table[state][action]):
                for array, value in zip((shares, after, rewards, ends), outcome, strict=True):
                    array[state, action, at] = value
        self.shares, self.rewards = jnp.array(shares), jnp.array(rewards)
        self.after, self.ends = jnp.array(after, int), jnp.array(ends, bool)
        self.begin = jnp.array(env.unwrapped.initial_state_distrib)
        places = [numpy.array(numpy.unravel_index(state, env.shape)) for state in range(states)]
        bits = [numpy.concatenate([numpy.eye(n)[at] for n, at in zip(env.shape, place, strict=True)]) for place in places]
        self.bits, self.actions = jnp.array(bits, jnp.float32), actions

    def reset(self, key, params):
        at = jax.random.choice(key, len(self.begin), p=self.begin)
        return self.bits[at], State(at=at, time=0)

    def step(self, key, state, action, params):
        of_outcome, of_reset = jax.random.split(key)
        outcome = jax.random.choice(of_outcome, self.shares.shape[2], p=self.shares[state.at, action])
        where = (state.at, action, outcome)
        moved = State(at=self.after[where], time=state.time + 1)
        done = self.ends[where] | (moved.time >= params.max_steps_in_episode)
        _, fresh = self.reset(of_reset, params)
        following = jax.tree.map(lambda new, old: jnp.where(done, new, old), fresh, moved)
        return self.bits[following.at], following, self.rewards[where], done, {}

    def action_space(self, params):
        return spaces.Discrete(self.actions)

    def observation_space(self, params):
        return spaces.Box(0.0, 1.0, (self.bits.shape[1],))


def rows_of(problem, runs):
    """Trains all seeds, and returns their rows."""
    steps, between, _ = BUDGETS[problem]
    env = MAKE[problem]()
    # Evaluations follow whole batches.
    between = max(between // (LANES * STEPS), 1) * LANES * STEPS
    steps = steps // between * between
    agent = PPO.create(
        env=Table(env),
        env_params=Params(),
        total_timesteps=steps,
        eval_freq=between,
        num_envs=LANES,
        num_steps=STEPS,
        num_epochs=4,
        num_minibatches=4,
        learning_rate=1e-3,
        gamma=GAMMA,
        normalize_rewards=True,
        skip_initial_evaluation=True,
    )
    keys = jnp.stack([jax.random.PRNGKey(seed) for seed in range(1, runs + 1)])
    begin = time.process_time()
    _, (_, returns) = jax.block_until_ready(jax.jit(jax.vmap(agent.train))(keys))
    spent = time.process_time() - begin
    best = best_return(env, [])
    rows = []
    for seed, curve in enumerate(numpy.asarray(returns).mean(axis=2), start=1):
        enough = curve >= best - 0.1 * abs(best)
        at = numpy.flatnonzero(enough[:-1] & enough[1:])
        reached = int(at[0] + 1) * between if at.size else None
        row = {"method": "ppo", "problem": problem, "seed": seed, "best": best, "steps": reached}
        row |= {"last": float(curve[-1]), "greatest": float(curve.max()), "cpu_s": round(spent / runs, 2)}
        rows.append(row)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=RUNS, help="the runs of each")
    parser.add_argument("--file", type=Path, default=FILE, help="results, to which rows are added")
    given = parser.parse_args()
    for problem in list(BUDGETS)[:3]:
        rows = read(given.file)
        is_own = [(row["method"], row["problem"]) == ("ppo", problem) for row in rows]
        if sum(is_own) >= given.runs:
            continue
        others = [row for row, own in zip(rows, is_own, strict=True) if not own]
        found = rows_of(problem, given.runs)
        print(problem, [row["steps"] for row in found], flush=True)
        write(given.file, others + found)


if __name__ == "__main__":
    main()
