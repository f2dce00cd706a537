"""The environments of learning.py, each with coordinates as percepts, and their best returns."""

import collections

import gymnasium
import minigrid  # noqa: F401
import numpy
from gymnasium import spaces

STEP_LIMIT = 200


class Coordinates(gymnasium.ObservationWrapper):
    """Shows the number of a state as coordinates."""

    def __init__(self, env, shape, names):
        super().__init__(env)
        self.shape, self.names = shape, names
        self.observation_space = spaces.MultiDiscrete(shape)

    def observation(self, observation):
        return numpy.array(numpy.unravel_index(int(observation), self.shape))


class Symbols(gymnasium.ObservationWrapper):
    """Shows what a MiniGrid agent sees as bits: for each of the 7 x 7 cells in front of it whether there is a wall, a goal,
    a key, a shut door or an open door. The last bit is whether it carries anything.
    """

    KINDS = [("wall", 2), ("goal", 8), ("key", 5), ("door", 4)]
    OPEN = 0

    def __init__(self, env):
        super().__init__(env)
        kinds = [name for name, _ in self.KINDS] + ["open door"]
        where = [f"{6 - row} ahead {col - 3:+d}" for col in range(7) for row in range(7)]
        self.names = [f"{kind} {at}" for kind in kinds for at in where] + ["carries"]
        self.observation_space = spaces.MultiBinary(len(self.names))

    def observation(self, observation):
        kinds, states = observation["image"][:, :, 0], observation["image"][:, :, 2]
        is_open = (kinds == 4) & (states == self.OPEN)
        layers = [(kinds == number) & ~is_open for _, number in self.KINDS] + [is_open]
        carries = self.unwrapped.carrying is not None
        return numpy.append(numpy.stack(layers).reshape(-1), carries).astype(numpy.int8)


def toy(name, shape, names, **arguments):
    env = gymnasium.make(name, disable_env_checker=True, max_episode_steps=STEP_LIMIT, **arguments)
    return Coordinates(env, shape, names)


def grid(name):
    return Symbols(gymnasium.make(name, disable_env_checker=True))


MAKE = {
    "FrozenLake-v1 8x8": lambda: toy("FrozenLake-v1", (8, 8), ["row", "column"], map_name="8x8"),
    "Taxi-v4": lambda: toy("Taxi-v4", (5, 5, 5, 4), ["row", "column", "passenger", "destination"]),
    "CliffWalking-v1": lambda: toy("CliffWalking-v1", (4, 12), ["row", "column"]),
    "MiniGrid-Empty-6x6": lambda: grid("MiniGrid-Empty-6x6-v0"),
    "MiniGrid-FourRooms": lambda: grid("MiniGrid-FourRooms-v0"),
    "MiniGrid-DoorKey-5x5": lambda: grid("MiniGrid-DoorKey-5x5-v0"),
}


def best_return(env, seeds):
    """Returns the mean of the best possible returns of the episodes with these seeds."""
    if hasattr(env.unwrapped, "P"):
        return best_of_table(env.unwrapped)
    returns = []
    for seed in seeds:
        env.reset(seed=seed)
        steps = fewest_steps(env.unwrapped)
        returns.append(1 - 0.9 * steps / env.unwrapped.max_steps)
    return float(numpy.mean(returns))


def best_of_table(env):
    """Returns the best expected return in `STEP_LIMIT` steps, by dynamic programming."""
    value = numpy.zeros(len(env.P))

    def of(outcomes):
        return sum(share * (reward + (0.0 if done else value[after])) for share, after, reward, done in outcomes)

    for _ in range(STEP_LIMIT):
        value = numpy.array([max(of(outcomes) for outcomes in env.P[state].values()) for state in range(len(env.P))])
    return float(value @ env.initial_state_distrib)


def fewest_steps(env):
    """Returns the fewest steps to the goal from the start of a MiniGrid episode, by breadth-first search."""
    begin = (*env.agent_pos, env.agent_dir, False, False)
    queue, distance = collections.deque([begin]), {begin: 0}
    while queue:
        x, y, direction, has_key, is_open = state = queue.popleft()
        dx, dy = [(1, 0), (0, 1), (-1, 0), (0, -1)][direction]
        front = env.grid.get(x + dx, y + dy)
        kind = None if front is None else front.type
        if (kind == "key" and has_key) or (kind == "door" and is_open):
            kind = None
        if kind == "goal":
            return distance[state] + 1
        following = [(x, y, (direction + turn) % 4, has_key, is_open) for turn in (1, 3)]
        if kind is None:
            following.append((x + dx, y + dy, direction, has_key, is_open))
        if kind == "key":
            following.append((x, y, direction, True, is_open))
        if kind == "door" and has_key:
            following.append((x, y, direction, has_key, True))
        for after in following:
            if after not in distance:
                distance[after] = distance[state] + 1
                queue.append(after)
    raise ValueError("the goal cannot be reached")
