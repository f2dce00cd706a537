"""A mobile robot in a physics-simulated maze, and learners of readable rules.

>>> import gymnasium
>>> import xcscr
>>> env = gymnasium.make("xcscr/Maze4-v0")
>>> result = xcscr.train("maze4", arena="grid", episodes=20)
"""

from importlib import metadata
from typing import TYPE_CHECKING, Any

from gymnasium.envs.registration import register, registry

from ._native import bundled_worlds, methods, sensors, verify_recording
from .envs import MazeEnv
from .learning import Result, Rule, train
from .parameters import Parameters
from .recording import Record, RecordVector
from .rules import XCSRule
from .studies import Study, study
from .vector import MazeVectorEnv
from .wheels import WheelsEnv
from .xcs import XCS

if TYPE_CHECKING:
    from .classifier import XCSClassifier as XCSClassifier

__all__ = [
    "MazeEnv",
    "MazeVectorEnv",
    "Parameters",
    "Record",
    "RecordVector",
    "Result",
    "Rule",
    "Study",
    "WheelsEnv",
    "XCS",
    "XCSRule",
    "bundled_worlds",
    "methods",
    "sensors",
    "study",
    "train",
    "verify_recording",
]
__version__ = metadata.version("xcscr")


def __getattr__(name: str) -> Any:
    """Imports the classifier on first use, because it needs scikit-learn."""
    if name != "XCSClassifier":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .classifier import XCSClassifier

    return XCSClassifier


def _id(world: str) -> str:
    """Returns the identifier of a bundled world: `maze4-classic` is `xcscr/Maze4Classic-v0`."""
    return "xcscr/" + "".join(part[:1].upper() + part[1:] for part in world.split("-")) + "-v0"


def _register() -> None:
    entry, many = "xcscr.envs:MazeEnv", "xcscr.vector:MazeVectorEnv"
    if "xcscr/Maze-v0" not in registry:
        register("xcscr/Maze-v0", entry_point=entry, vector_entry_point=many)
    if "xcscr/Wheels-v0" not in registry:
        register("xcscr/Wheels-v0", entry_point="xcscr.wheels:WheelsEnv")
    for world in bundled_worlds():
        if _id(world) not in registry:
            register(_id(world), entry_point=entry, vector_entry_point=many, kwargs={"world": world})


_register()
