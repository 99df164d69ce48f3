"""How much is measured: seeds, episodes and times, for a quick look and for the whole.

In: quick or not. Out: a `Budget`, which is kept beside every result.
"""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Budget:
    """What an experiment may spend.

    seeds: of every experiment on maps. car_seeds: of Mountain Car by bins. car_episodes, car_steps: training
    episodes there, and the step limit of each. repeats: of everything that is timed. irl_seconds: what MCE-IRL may
    take on each task, in seconds; irl_steps: its gradient steps at most.
    """

    name: str
    seeds: int
    car_seeds: tuple[tuple[int, int], ...]
    car_episodes: int
    car_steps: int
    repeats: int
    irl_seconds: float
    irl_steps: int

    def to_json(self) -> dict[str, Any]:
        """Return it as JSON has it: lists, no tuples."""
        return asdict(self) | {"car_seeds": [list(pair) for pair in self.car_seeds]}


QUICK = Budget("quick", 3, ((50, 1), (75, 1), (100, 1)), 300, 1000, 5, 10.0, 1000)
FULL = Budget("full", 20, ((50, 5), (75, 2), (100, 2)), 5000, 1000, 21, 240.0, 100_000)
