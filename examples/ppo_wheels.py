"""PPO of Stable-Baselines3 learns to drive the wheels of the robot to the goal, without a controller.

    pip install "./python" stable-baselines3
    python examples/ppo_wheels.py [steps, 50,000 by default] [seed, 1 by default]

It prints the share of episodes that reach the goal, before and after the training, with the greedy policy.
"""

import sys

import gymnasium
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import DummyVecEnv

WORLD = '{"name": "hall", "rows": ["#######", "#.....#", "#.###.#", "#...#.#", "#.#.#.#", "#.#..G#", "#######"]}'


class Approach(gymnasium.Wrapper):
    """Holds each action for 0.2 s, and rewards each metre by which the robot gets closer to the goal."""

    def reset(self, **given):
        observation, info = self.env.reset(**given)
        self.distance_m = info["goal_distance"]
        return observation, info

    def step(self, action):
        total = 0.0
        for _ in range(4):
            observation, reward, terminated, truncated, info = self.env.step(action)
            total += reward + self.distance_m - info["goal_distance"]
            self.distance_m = info["goal_distance"]
            if terminated or truncated:
                break
        return observation, total, terminated, truncated, info


def make():
    return Approach(gymnasium.make("xcscr:xcscr/Wheels-v0", world=WORLD, max_steps=600, goal_reward=10.0))


def successes(model, episodes=50):
    """Returns the share of episodes in which the greedy policy reaches the goal."""
    env, reached = make(), 0
    for episode in range(episodes):
        observation, _ = env.reset(seed=100_000 + episode)
        done = False
        while not done:
            observation, _, terminated, truncated, _ = env.step(model.predict(observation, deterministic=True)[0])
            done = terminated or truncated
        reached += terminated
    return reached / episodes


steps, seed = int((sys.argv[1:] or ["50000"])[0]), int((sys.argv[2:] or ["1"])[0])
model = PPO("MlpPolicy", DummyVecEnv([make] * 8), n_steps=256, batch_size=256, learning_rate=1e-3, gamma=0.98, seed=seed)
print(f"before: {successes(model):.2f}")
model.learn(steps)
print(f"after {model.num_timesteps:,} decisions: {successes(model):.2f}")
