"""Many environments, stepped in parallel by native threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from . import checks
from ._native import Robot, Robots
from .choice import environment, rewards, with_goal
from .envs import MazeEnv

#: The noise seed, the start, the actions and the rewards of an episode.
History = tuple[int, tuple[int, int], list[int], list[float]]
#: The number of an environment, the noise seed and the start of a new episode.
Begin = tuple[int, int, tuple[int, int]]
#: The number of an environment, what happened in an episode, and the pose at its end.
Episode = tuple[int, History, tuple[float, ...]]
Recorder = Callable[[int, History, tuple[float, ...]], None]

#: The maximum number of environments. A robot in physics takes some 100 kB.
MOST_ENVS = 1 << 16
#: More steps than an episode can have.
MOST_STEPS = 2**63

COLLIDED, REACHED_GOAL, RESTS = 1, 3, 255
#: The names of all bytes that stand for an outcome. An environment that rests has the first name, and its mask is false.
OUTCOMES = np.full(256, "moved", object)
OUTCOMES[:4] = ["moved", "collided", "stalled", "reached-goal"]


class MazeVectorEnv(VectorEnv[np.ndarray, np.ndarray, np.ndarray]):
    """`num_envs` copies of `MazeEnv`, with its arguments. Environment `i` equals a `MazeEnv` with the seed `seed + i`.

    The robots move on all cores without holding Python's lock. The results do not depend on the number of cores or of other
    environments. `autoreset_mode` selects when a finished environment is reset: in the next step (`AutoresetMode.NEXT_STEP`), in
    the same step (`SAME_STEP`; `infos` then has `final_obs` and `final_info`), or only by the caller (`DISABLED`).
    `reset(options={"reset_mask": mask})` resets some of the environments. `max_episode_steps` can only shorten episodes, as in
    `gymnasium.make`.

    `infos` has arrays by environment: `cell`, `pose`, `collision_impulse`, `shortest_distance` (-1 without a path) and, after a
    step, `outcome`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        world: str | os.PathLike[str] = "maze4",
        arena: str = "physics",
        sensor: str | None = None,
        robot: str | os.PathLike[str] | None = None,
        noise: float | None = None,
        slip: float = 0.0,
        settings: dict[str, Any] | None = None,
        goal_reward: float = 1.0,
        step_reward: float = 0.0,
        collision_reward: float = 0.0,
        max_steps: int | None = None,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    ) -> None:
        if render_mode is not None:
            raise ValueError("a vector environment cannot render: leave `render_mode` out")
        num_envs = checks.whole("num_envs", num_envs, 1, MOST_ENVS)
        limit = None if max_steps is None else checks.whole("max_steps", max_steps, 1)
        shorter = None if max_episode_steps is None else checks.whole("max_episode_steps", max_episode_steps, 1)
        goal, each, collision = rewards(goal_reward, step_reward, collision_reward)
        self._given = environment(world, arena, sensor, robot, noise, slip, settings)
        self.num_envs = num_envs
        self.render_mode = None
        self._mode = AutoresetMode(autoreset_mode)
        self.metadata = MazeEnv.metadata | {"autoreset_mode": self._mode}
        self._place(self._given)
        one = Robot(self._given)
        #: The reward of each outcome byte.
        self._rewards = np.full(256, each, np.float64)
        self._rewards[REACHED_GOAL] = goal
        self._rewards[COLLIDED] += collision
        self._rewards[RESTS] = 0.0
        self._max_steps = min(limit or one.step_threshold, shorter or MOST_STEPS)
        self.single_action_space = gymnasium.spaces.Discrete(one.actions)
        self.single_observation_space = gymnasium.spaces.MultiBinary(one.percept_bits)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._bits, self._actions = one.percept_bits, one.actions
        self._recorder: Recorder | None = None
        self._histories: list[History | None] = [None] * num_envs
        self._draws = [np.random.default_rng() for _ in range(num_envs)]
        self._steps = np.zeros(num_envs, np.int64)
        self._done = np.zeros(num_envs, np.bool_)
        self._begun = np.zeros(num_envs, np.bool_)

    def _place(self, chosen: dict[str, Any]) -> None:
        """Loads the maze of a choice. The robots are not placed yet."""
        self._robots = Robots(chosen, self.num_envs)
        self._starts = Robot(chosen).start_cells

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        options = dict(options or {})
        unknown = options.keys() - {"start", "goal", "reset_mask"}
        if unknown:
            raise ValueError(f"unknown options {sorted(unknown)}: only `start`, `goal` and `reset_mask` are known")
        mask = options.get("reset_mask")
        mask = np.ones(self.num_envs, np.bool_) if mask is None else np.asarray(mask, np.bool_)
        if mask.shape != (self.num_envs,) or not mask.any():
            raise ValueError(f"`reset_mask` must have {self.num_envs} entries, at least one of them true")
        seeds = self._seeds(seed)
        start = None if options.get("start") is None else checks.cell("start", options["start"])
        if "goal" in options:
            if not mask.all():
                raise ValueError("`goal` moves the goal of all environments: leave `reset_mask` out")
            self._place(with_goal(self._given, options["goal"]))
        for lane in np.flatnonzero(mask):
            if seeds[lane] is not None:
                self._draws[lane] = gymnasium.utils.seeding.np_random(seeds[lane])[0]
        self._begin(np.flatnonzero(mask), start)
        percepts, facts = self._robots.observe()
        return self._observations(percepts), self._infos(facts, mask)

    def _seeds(self, seed: Any) -> list[int | None]:
        """Returns the seed of each environment."""
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, Sequence) or np.ndim(seed) == 1:
            if len(seed) != self.num_envs:
                raise ValueError(f"there are {len(seed)} seeds for {self.num_envs} environments")
            return [None if each is None else checks.whole("seed", each) for each in seed]
        first = checks.whole("seed", seed)
        return [first + lane for lane in range(self.num_envs)]

    def _begin(self, lanes: np.ndarray, start: tuple[int, int] | None = None) -> None:
        """Starts an episode in some of the environments, as `MazeEnv.reset` does."""
        begins, ended = self._drawn(lanes, start), self._recorded(lanes)
        self._robots.reset(begins)
        self._hand_over(ended, begins)
        self._steps[lanes] = 0
        self._done[lanes] = False
        self._begun[lanes] = True

    def _drawn(self, lanes: np.ndarray, start: tuple[int, int] | None = None) -> list[Begin]:
        """Draws new episodes for some of the environments."""
        begins = []
        for lane in lanes.tolist():
            draws = self._draws[lane]
            noise = int(draws.integers(2**63))
            cell = self._starts[int(draws.integers(len(self._starts)))] if start is None else start
            begins.append((lane, noise, (int(cell[0]), int(cell[1]))))
        return begins

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        if not self._begun.all():
            raise gymnasium.error.ResetNeeded("call reset before step")
        actions = self._checked(actions)
        over = self._done
        if self._mode == AutoresetMode.DISABLED and over.any():
            raise gymnasium.error.ResetNeeded(f"the episodes of environments {np.flatnonzero(over).tolist()} are over: reset them")
        # Finished environments do not act in this step: they are reset.
        begins, ended = self._drawn(np.flatnonzero(over)), self._recorded(np.flatnonzero(over))
        codes, (percepts, facts) = self._robots.step(np.where(over, RESTS, actions).astype(np.uint8).tobytes(), begins)
        self._hand_over(ended, begins)
        outcome = np.frombuffer(codes, np.uint8)
        acted = ~over
        self._steps = np.where(over, 0, self._steps + 1)
        rewards = self._rewards[outcome]
        if self._recorder is not None:
            self._note(actions, rewards, acted)
        terminations = outcome == REACHED_GOAL
        truncations = acted & ~terminations & (self._steps >= self._max_steps)
        self._done = terminations | truncations
        infos = self._infos(facts, np.ones(self.num_envs, np.bool_))
        self._add(infos, "outcome", OUTCOMES[outcome], acted)
        observations = self._observations(percepts)
        if self._mode == AutoresetMode.SAME_STEP and self._done.any():
            infos, observations = self._after_end(infos, observations)
        return observations, rewards, terminations, truncations, infos

    def _checked(self, actions: Any) -> np.ndarray:
        """Returns the actions as an array of whole numbers."""
        given = np.asarray(actions)
        is_whole = given.shape == (self.num_envs,) and np.issubdtype(given.dtype, np.integer)
        if not is_whole or (given < 0).any() or (given >= self._actions).any():
            wanted = f"{self.num_envs} whole numbers from 0 to {self._actions - 1}"
            raise ValueError(f"`actions` is {checks.shown(actions)}, but must be {wanted}")
        return given

    def _note(self, actions: np.ndarray, rewards: np.ndarray, acted: np.ndarray) -> None:
        """Adds a step to the histories of the environments that acted."""
        for lane in np.flatnonzero(acted):
            history = self._histories[lane]
            if history is not None:
                history[2].append(int(actions[lane]))
                history[3].append(float(rewards[lane]))

    def _recorded(self, lanes: np.ndarray) -> list[Episode]:
        """Returns the recorded episodes of some of the environments, with the poses at their ends."""
        if self._recorder is None:
            return []
        histories = [(lane, self._histories[lane]) for lane in lanes.tolist()]
        recorded = [(lane, history) for lane, history in histories if history is not None and history[2]]
        if not recorded:
            return []
        _, facts = self._robots.observe()
        poses = np.frombuffer(facts).reshape(self.num_envs, -1)[:, 2:5]
        return [(lane, history, tuple(poses[lane].tolist())) for lane, history in recorded]

    def _hand_over(self, episodes: list[Episode], begins: list[Begin]) -> None:
        """Passes episodes to the recorder, and starts the histories of new ones."""
        if self._recorder is None:
            return
        for lane, noise, start in begins:
            self._histories[lane] = (noise, start, [], [])
        for episode in episodes:
            self._recorder(*episode)

    def _finish(self) -> None:
        """Passes the unfinished episodes to the recorder."""
        ended = self._recorded(np.arange(self.num_envs))
        self._histories = [None] * self.num_envs
        self._hand_over(ended, [])

    def _after_end(self, infos: dict[str, Any], observations: np.ndarray) -> tuple[dict[str, Any], np.ndarray]:
        """Resets the finished environments and stores their final observations and infos."""
        ended = self._done.copy()
        last = np.full(self.num_envs, None, object)
        for lane in np.flatnonzero(ended):
            last[lane] = observations[lane].copy()
        self._begin(np.flatnonzero(ended))
        percepts, facts = self._robots.observe()
        fresh = self._infos(facts, np.ones(self.num_envs, np.bool_))
        self._add(fresh, "outcome", infos["outcome"], infos["_outcome"] & ~ended)
        self._add(fresh, "final_obs", last, ended)
        final_info = {name: values for name, values in infos.items() if not name.startswith("_")}
        for name in list(final_info):
            final_info["_" + name] = infos["_" + name] & ended
        self._add(fresh, "final_info", final_info, ended)
        return fresh, self._observations(percepts)

    @staticmethod
    def _add(infos: dict[str, Any], name: str, values: Any, mask: np.ndarray) -> None:
        infos[name], infos["_" + name] = values, mask.copy()

    def _observations(self, percepts: bytes) -> np.ndarray:
        return np.frombuffer(percepts, np.int8).reshape(self.num_envs, self._bits).copy()

    def _infos(self, states: bytes, mask: np.ndarray) -> dict[str, Any]:
        facts = np.frombuffer(states).reshape(self.num_envs, -1)
        infos: dict[str, Any] = {}
        self._add(infos, "cell", facts[:, :2].astype(np.int64), mask)
        self._add(infos, "pose", facts[:, 2:5].copy(), mask)
        self._add(infos, "collision_impulse", facts[:, 5].copy(), mask)
        self._add(infos, "shortest_distance", facts[:, 6].astype(np.int64), mask)
        return infos
