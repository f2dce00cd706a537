"""Studies that compare agents of Python with the methods of the program."""

from __future__ import annotations

import difflib
import json
import math
import os
import re
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from statistics import NormalDist
from typing import Any, Protocol

import numpy

from . import _native, checks
from .choice import plain_settings

#: The columns of text in the tables of a study.
TEXTS = ("world", "method", "arena", "sensor", "variant", "error")
#: The maximum numbers of trials, of episodes, and of threads.
MOST_TRIALS, MOST_JOBS = 1_000_000, 1024


class Agent(Protocol):
    """What a study needs of an agent.

    A percept is a `bytes` with a 0 or 1 for each bit; `numpy.frombuffer(percept, "int8")` is the observation of the
    environment. The study builds an agent for each trial with the arguments `n_actions`, `n_bits` and `seed`.

    An agent may also have `choose(percept)`, which returns an action. Without it, the study explores:
    a random action with the probability `episode.explore`, and otherwise one of the best. With it, the study
    still judges the greedy policy by `values`. `len(agent)`, if there is one, is reported as the number of rules.
    """

    def values(self, percept: bytes) -> Sequence[float | None]:
        """Returns the value of each action, `None` where it is unknown. Must not change the agent."""

    def learn(self, percept: bytes, action: int, reward: float, next_percept: bytes | None) -> None:
        """Learns from a step; `next_percept` is `None` at a goal, and only there."""

    def end_episode(self, reached_goal: bool) -> None:
        """Ends an episode: at a goal, or at the step limit."""


class Study:
    """A finished study."""

    def __init__(self, native: _native.Study, folder: Path, jobs: int, temporary: Any = None) -> None:
        self._native = native
        self._jobs = jobs
        self._temporary = temporary
        self.folder = folder
        """The folder with `report.html`, figures and tables."""

    def trials(self) -> Any:
        """A pandas frame with a row for each trial."""
        return _table(self.folder / "trials.csv")

    def episodes(self) -> Any:
        """A pandas frame with a row for each episode. The first call repeats the trials."""
        table = self.folder / "episodes.csv.gz"
        if not table.exists():
            self._native.write_episodes(self._jobs)
        return _table(table)

    def summary(self) -> Any:
        """A pandas frame with a row for each method in each world: the numbers of the report. `to_latex` writes a frame as
        a table for a paper.
        """
        import pandas  # type: ignore[import-untyped]

        return pandas.DataFrame(json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))["arms"])

    def curves(self, points: int = 100) -> Any:
        """Learning curves over environment steps: a pandas frame with a row for each world, method and number of steps.

        `optimal` is the share of trials whose greedy policy is globally optimal after so many steps, and `low` and `high`
        are the limits of its 95 % interval (Wilson). After its last episode, a trial counts with its last policy. The
        numbers of steps are at most `points`, evenly spaced on a logarithmic scale.
        """
        import pandas

        points = checks.whole("points", points, 2)
        rows = []
        for world, of_world in self.episodes().groupby("world", sort=False):
            of_world = of_world.assign(end=of_world.groupby(["method", "trial"], sort=False)["steps"].cumsum())
            steps = numpy.unique(numpy.geomspace(1, of_world["end"].max(), points).round().astype(int))
            for method, of_method in of_world.groupby("method", sort=False):
                trials = [trial for _, trial in of_method.groupby("trial")]
                solved = sum(_optimal_at(steps, trial["end"].to_numpy(), trial["optimal"].to_numpy()) for trial in trials)
                low, high = _wilson(solved, len(trials))
                columns = {"steps": steps, "optimal": solved / len(trials), "low": low, "high": high}
                rows.append(pandas.DataFrame({"world": world, "method": method} | columns))
        return pandas.concat(rows, ignore_index=True)

    def report(self) -> str:
        """The report as text. `folder / "report.html"` has the figures."""
        return self._native.report()

    def scores(self, score: Callable[[Any], Any] | None = None) -> dict[str, Any]:
        """For each method an array of scores with a row for each trial and a column for each world, as `rliable` reads them.

        `score` maps the frame of `episodes()` of one trial to a number. By default it is the share of episodes after
        which the greedy policy is globally optimal. A trial that failed has NaN.
        """
        keys = ["method", "world", "trial"]
        episodes = self.episodes()
        methods, worlds, trials = ({name: at for at, name in enumerate(episodes[key].unique())} for key in keys)
        scores = {str(method): numpy.full((len(trials), len(worlds)), numpy.nan) for method in methods}
        for (method, world, trial), rows in episodes.groupby(keys, sort=False):
            one = rows["optimal"].mean() if score is None else score(rows.drop(columns=keys))
            scores[str(method)][trials[trial], worlds[world]] = one
        return scores

    def __repr__(self) -> str:
        return f"<study in {self.folder}>"


def _optimal_at(steps: Any, ends: Any, optimal: Any) -> Any:
    """Returns for each number of steps whether the policy is optimal by then, from the steps at which episodes ended."""
    episode = numpy.searchsorted(ends, steps, side="right") - 1
    return (episode >= 0) & optimal[episode]


def _wilson(successes: Any, trials: int) -> tuple[Any, Any]:
    """Returns the limits of Wilson's 95 % interval of a share."""
    z = NormalDist().inv_cdf(0.975)
    middle, width = successes + z * z / 2, z * numpy.sqrt(successes * (trials - successes) / trials + z * z / 4)
    return (middle - width) / (trials + z * z), (middle + width) / (trials + z * z)


def _table(path: Path) -> Any:
    """Reads a table of a study. Names stay text, even `001`, `nan` and `1e5`."""
    import pandas

    columns = pandas.read_csv(path, nrows=0).columns
    empty = {column: [""] for column in columns if column not in TEXTS}
    return pandas.read_csv(path, dtype=dict.fromkeys(TEXTS, str), keep_default_na=False, na_values=empty)


def study(
    worlds: Sequence[str | os.PathLike[str]],
    methods: Sequence[str | Callable[..., Agent] | tuple[str, Callable[..., Agent]]],
    *,
    trials: int = 30,
    episodes: int = 180,
    arena: str = "grid",
    sensor: str | None = None,
    settings: dict[str, Any] | None = None,
    reference: str | Callable[..., Agent] | None = None,
    seed: int = 1,
    out: str | os.PathLike[str] | None = None,
    jobs: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> Study:
    """Runs paired trials of each method in each world, and compares them.

    `methods` are names (`xcscr.methods()`) and your own agents: see `xcscr.studies.Agent`. An agent is a class, or a pair
    of a name and a function that builds the agent, such as `("slow", functools.partial(MyAgent, rate=0.1))`. Trial n has
    the same seed for all methods. The report compares `reference`, one of the methods, with each other one; by default
    it is `xcscr-plus`, or else `xcscr`, or else your last agent, or else the last method.

    `out` keeps the study in a folder, and the same call resumes it there. A call with more trials, methods or worlds
    adds them to the study. Choose another folder when the code of an agent has changed: one trial of each agent is
    repeated, and another result than the stored one raises ValueError. `jobs` is the number of threads, 0 for all
    cores; the results do not depend on it. After each trial, `progress` is called with the number of finished trials
    and the number of trials that this call runs.
    """
    if isinstance(methods, Iterable) and not isinstance(methods, str):
        methods = list(methods)
    text = _study_file(worlds, methods, trials, episodes, arena, sensor, settings, seed)
    agents = [_named(method) for method in methods if not isinstance(method, str)]
    if reference is not None:
        known = [method for method in methods if isinstance(method, str)] + [name for name, _ in agents]
        reference = _one_of("reference", _named(reference)[0] if callable(reference) else reference, known)
    jobs = checks.whole("jobs", jobs, 0, MOST_JOBS)
    out = None if out is None else checks.text("out", out)
    temporary = tempfile.TemporaryDirectory(prefix="xcscr-study-") if out is None else None
    folder = Path(temporary.name if temporary else out or "")
    try:
        native = _native.run_study(text, agents, reference, str(folder), jobs, progress)
    except BaseException:
        if temporary:
            temporary.cleanup()
        raise
    return Study(native, folder, jobs, temporary)


def _study_file(
    worlds: Any, methods: Any, trials: Any, episodes: Any, arena: Any, sensor: Any, settings: Any, seed: Any
) -> str:
    """Returns the text of a study file with these arguments."""
    for name, given in (("worlds", worlds), ("methods", methods)):
        if isinstance(given, str | bytes | os.PathLike) or not isinstance(given, Iterable):
            raise ValueError(f"`{name}` is {checks.shown(given)}, but must be a list of {name}")
    names = [method for method in methods if isinstance(method, str)]
    table: dict[str, Any] = {
        "name": "study",
        "worlds": [checks.text("worlds", world) for world in worlds],
        "methods": [_one_of("methods", name, _native.methods()) for name in names],
        "arenas": [_one_of("arena", arena, ["grid", "physics"])],
        "trials": checks.whole("trials", trials, 1, MOST_TRIALS),
        "episodes": checks.whole("episodes", episodes, 1, MOST_TRIALS),
        # TOML has no larger numbers.
        "seed": checks.whole("seed", seed, 0, 2**63 - 1),
    }
    if sensor is not None:
        table["sensors"] = [_one_of("sensor", sensor, _native.sensors())]
    lines = [f"{key} = {_toml(value)}" for key, value in table.items()]
    lines += ["[settings]"] + [f"{_toml(key)} = {_toml(value)}" for key, value in plain_settings(settings).items()]
    return "\n".join(lines)


def _toml(value: Any) -> str:
    """Returns a value in TOML, which differs from JSON in the numbers that are not finite and in the delete character."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _one_of(name: str, value: Any, known: Sequence[str]) -> str:
    """Returns a name that is known."""
    given = checks.text(name, value)
    if given in known:
        return given
    near = difflib.get_close_matches(given, known, 1)
    hint = f"did you mean `{near[0]}`?" if near else f"choose one of {', '.join(known)}"
    raise ValueError(f"`{name}` has {checks.shown(given)}, which is unknown: {hint}")


def _named(agent: Any) -> tuple[str, Callable[..., Agent]]:
    """An agent and its name in reports: that of a pair, or that of a class, where `MyAgent` is `my-agent`."""
    if isinstance(agent, tuple) and len(agent) == 2 and isinstance(agent[0], str) and callable(agent[1]):
        return agent
    if not callable(agent):
        raise ValueError(
            f"`methods` has {checks.shown(agent)}, but a method is a name, a class of your own agent, or a pair of a name and a "
            "function that builds the agent"
        )
    name = getattr(agent, "__name__", None)
    if not isinstance(name, str) or not re.fullmatch("[A-Za-z0-9_]{1,40}", name):
        raise ValueError(
            f"`methods` has {checks.shown(name or agent)}, which has no name for the report: pass a class, or a pair of a "
            "name and a function that builds the agent"
        )
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", name).replace("_", "-").strip("-").lower(), agent
