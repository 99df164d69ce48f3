"""How much is measured: seeds, episodes and times, for a quick look and for the whole.

In: quick or not. Out: a `Budget`, which is kept beside every result.
"""

from dataclasses import asdict, dataclass
from typing import Any

from stlspec.paper.irl import ITERATIONS


@dataclass(frozen=True, slots=True)
class Budget:
    """What an experiment may spend.

    seeds: of every experiment on maps. car_seeds: of Mountain Car by bins. car_episodes, car_steps: training
    episodes there, and the step limit of each. repeats: of everything that is timed. irl_iterations: gradient
    steps of MCE-IRL, its library's own default; irl_seconds: after which it stops, and the time is extrapolated.
    """

    name: str
    seeds: int
    car_seeds: tuple[tuple[int, int], ...]
    car_episodes: int
    car_steps: int
    repeats: int
    irl_iterations: int
    irl_seconds: float

    def to_json(self) -> dict[str, Any]:
        """Return it as JSON has it: lists, no tuples."""
        return asdict(self) | {"car_seeds": [list(pair) for pair in self.car_seeds]}


QUICK = Budget("quick", 3, ((50, 1), (75, 1), (100, 1)), 300, 1000, 5, ITERATIONS, 15.0)
FULL = Budget("full", 20, ((50, 5), (75, 2), (100, 2)), 5000, 1000, 21, ITERATIONS, 300.0)
