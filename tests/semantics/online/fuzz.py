"""Compare the monitor with the naive interval recursion, the offline engine and the oracle on many random cases.

`python tests/semantics/online/fuzz.py --cases 5000 --seed 0`, from the root of the repository.
"""

import argparse
import random
import sys
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))

from tests.semantics.online.cases import check_rest, check_start, nested_formula, random_case


def main(arguments=None):
    """Return 1 if anything disagrees."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--longest", type=int, default=12)
    options = parser.parse_args(arguments)
    rng = random.Random(options.seed)
    wrong = 0
    for i in range(options.cases):
        formula = nested_formula if i % 2 else None
        case = random_case(rng, formula, longest=options.longest)
        try:
            check_start(case)
            if i % 4 == 0:
                check_rest(case, rng)
        except Exception:
            wrong += 1
            if wrong <= 3:
                traceback.print_exc()
                print(case)
    print(f"{options.cases} cases, {wrong} disagreements")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
