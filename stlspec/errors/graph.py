"""G5xx: the requirements and the edges between them."""

from stlspec.errors.model import Code

_D = "signal d\n"

CODES: tuple[Code, ...] = (
    Code(
        "G501",
        "requirements that depend on each other",
        "error",
        message="requirements depend on each other in a circle: {cycle}",
        label="{edge}",
        help="remove one of these dependencies",
        explanation="Dependencies order the requirements: what comes first weighs more. A circle has no first.",
        bad=_D + "hard a depends on b: always (d > 1)\nhard b depends on a: always (d > 2)\n",
        good=_D + "hard a: always (d > 1)\nhard b depends on a: always (d > 2)\n",
    ),
    Code(
        "G502",
        "a dependency on nothing",
        "error",
        message="`{name}` depends on `{on}`, which is no requirement",
        help="{help}",
        explanation="`depends on` names requirements of this spec.",
        bad=_D + "hard a depends on z: always (d > 1)\n",
        good=_D + "hard z: always (d > 0)\nhard a depends on z: always (d > 1)\n",
    ),
    Code(
        "G503",
        "a requirement that depends on itself",
        "error",
        message="`{name}` depends on itself",
        help="remove `{name}` from its own `depends on`",
        explanation="A requirement cannot come before itself.",
        bad=_D + "hard a depends on a: always (d > 1)\n",
        good=_D + "hard a: always (d > 1)\n",
    ),
    Code(
        "G504",
        "hard depends on soft",
        "error",
        message="hard `{name}` depends on soft `{on}`",
        help="make `{on}` hard, or remove the dependency",
        explanation="What must hold cannot wait for what is only wanted.",
        bad=_D + "soft b: always (d > 1)\nhard a depends on b: always (d > 2)\n",
        good=_D + "hard b: always (d > 1)\nhard a depends on b: always (d > 2)\n",
    ),
    Code(
        "G505",
        "a soft requirement beside the hard ones",
        "warning",
        message="soft `{name}` depends on no hard requirement",
        help="write `depends on {hard}` in its header, so that it weighs less than what must hold",
        explanation="In the paper hard requirements come before soft ones. A soft one without a hard one before it "
        "weighs as much as what must hold.",
        bad=_D + "hard a: always (d > 1)\nsoft b: always (d > 2)\n",
        good=_D + "hard a: always (d > 1)\nsoft b depends on a: always (d > 2)\n",
    ),
    Code(
        "G506",
        "no requirement",
        "error",
        message="the spec states no requirement",
        help="state one, for instance `hard safe: always (x > 0)`",
        explanation="A bundle scores traces against requirements; without one there is nothing to compile.",
        bad="# stlspec compile declarations.stl -o out.stlb",
        good=_D + "hard safe: always (d > 1)\n",
        kind="shown",
    ),
    Code(
        "G507",
        "weights that vanish",
        "warning",
        message="{names} weigh less than 1/100 of the largest weight",
        help="a flatter graph keeps them visible in the score",
        explanation="Weights are the softmax of |Φ| - |ancestors|, so six levels of dependencies already differ by a "
        "factor of 148: the last ones hardly count in the reward of a demonstration.",
        bad=_D
        + "hard a: always (d > 1)\n"
        + "".join(
            f"soft {n} depends on {p}: always (d > {i})\n"
            for i, (p, n) in enumerate(zip("aefgh", "efghi", strict=True), 2)
        ),
        good=_D + "hard a: always (d > 1)\nsoft b depends on a: always (d > 2)\n",
    ),
)
