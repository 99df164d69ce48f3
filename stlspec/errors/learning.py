"""D860 to D879: scores that cannot be weighed, reward maps, and tasks that the learner cannot take."""

from stlspec.errors.model import Code

CODES: tuple[Code, ...] = (
    Code(
        "D860",
        "an infinite robustness that is not bounded",
        "error",
        message="'{requirement}' has robustness {value}, which `bound none` does not bound",
        help="write `bound tanh` or `bound linear` in the header of '{requirement}'",
        explanation="The reward of a demonstration is a weighted sum. One infinite term would hide all "
        "others, and two of opposite sign have no sum.",
        bad="# soft reach bound none: eventually (d_goal < 1)   with d_goal = inf\n",
        good="# soft reach bound tanh: eventually (d_goal < 1)\n",
        kind="shown",
    ),
    Code(
        "D861",
        "a demonstration without states",
        "error",
        message="demonstration '{name}' has no states, and rewards are values of states",
        help="add 'states' to the demonstration (JSON, NPZ), or the columns 'row' and 'col' (CSV)",
        explanation="Algorithm 1 gives a value to every state that a demonstration visits. Signals alone are "
        "enough to score a demonstration, but not to learn from it.",
        bad='{"schema": "stlspec.demo/1", "signals": {"d_obs": [1, 2]}}',
        good='{"schema": "stlspec.demo/1", "states": [[0, 0], [0, 1]], "signals": {"d_obs": [1, 2]}}',
        kind="shown",
    ),
    Code(
        "D862",
        "a state that the environment does not have",
        "error",
        message="state {state} of {what} is not a state of '{env}', which has {states} states",
        help="use an environment of the same size as the one that the demonstrations were made on",
        explanation="A reward map carries over to another map only if the states mean the same there, which "
        "on grids takes the same number of rows and columns.",
        bad="# a reward from a 10x10 grid, learned with --map five.txt\n",
        good="# a reward from a 5x5 grid, learned with --map five.txt\n",
        kind="shown",
    ),
    Code(
        "D863",
        "a damaged reward map",
        "error",
        message="not a usable reward map: {problem}",
        help="make it again: stlspec reward SPEC DEMO... -o R.json",
        explanation="A reward map is a JSON document of schema stlspec.reward/1: distinct states, one finite "
        "value in [-1, 1] for each.",
        bad='{"schema": "stlspec.reward/1", "states": [[0, 0]], "values": []}',
        good='{"schema": "stlspec.reward/1", "meaning_sha256": "...", "env": {...}, "states": [[0, 0]], '
        '"values": [1.0]}',
        kind="shown",
    ),
    Code(
        "D864",
        "a reward that is 0 everywhere",
        "warning",
        message="the inferred reward is 0 in every state{reason}",
        help="add a good demonstration; an incomplete one counts only if its weighted reward is positive",
        explanation="States get a positive value only from demonstrations that meet every hard requirement. "
        "With none of them the potential is 0, and the learner falls back on the base reward.",
        bad="# stlspec learn grid.stl --env stlspec/GridWorld-v0 --demos incomplete.json --out out\n",
        good="# stlspec learn grid.stl --env stlspec/GridWorld-v0 --demos good.json --out out\n",
        kind="shown",
    ),
    Code(
        "D865",
        "a reward map of another spec",
        "warning",
        message="the reward map was inferred from a spec with another meaning",
        help="harmless if only a param such as T_goal differs; else infer it again: "
        "stlspec reward SPEC DEMO... -o R.json",
        explanation="A reward map carries the hash of the meaning of the spec that ranked the "
        "demonstrations. Shaping never changes which policies are optimal, so learning goes on.",
        bad="# stlspec reward a.stl demos/*.json -o R.json; stlspec learn b.stl --reward R.json ...\n",
        good="# stlspec reward a.stl demos/*.json -o R.json; stlspec learn a.stl --reward R.json ...\n",
        kind="shown",
    ),
    Code(
        "D866",
        "a spec without a goal",
        "error",
        message="there is no goal to learn: no requirement has an `eventually` over a condition on the present sample",
        help="say where to get to, for example: soft reach: eventually (d_goal < 1)",
        explanation="An episode of training ends at a goal. Goals are the conditions on the present sample "
        "(no temporal operator, delta, rate or now) under an `eventually` of any requirement.",
        bad="signal d_obs\nhard avoid: always (d_obs >= 1)\n",
        good="signal d_obs\nsignal d_goal\nhard avoid: always (d_obs >= 1)\n"
        "soft reach depends on avoid: eventually (d_goal < 1)\n",
        kind="shown",
    ),
    Code(
        "D867",
        "several goals",
        "error",
        message="the spec has {count} goals, and the learner takes one: {goals}",
        help="several goals are not supported yet: keep one `eventually` condition in the spec to learn from",
        explanation="Every distinct condition under an `eventually` is a goal of its own. Visiting several "
        "(Algorithm 3) is not supported yet.",
        bad="signal d_1\nsignal d_2\nsoft both: eventually (d_1 < 1) and eventually (d_2 < 1)\n",
        good="signal d_1\nsoft first: eventually (d_1 < 1)\n",
        kind="shown",
    ),
    Code(
        "D868",
        "a hard requirement that the learner cannot watch step by step",
        "error",
        message="hard requirement '{requirement}' is not `always` of a condition on the present sample: {reason}",
        help="write it as `hard {requirement}: always (...)` without bounds, temporal operators, delta, rate "
        "and now inside, or make it soft",
        explanation="The learner watches hard requirements at every step, in a table over states. That works "
        "for `always` (without bounds) of a condition that looks at the present sample only.",
        bad="signal d_obs\nhard avoid: always[0, 10] (d_obs >= 1)\n",
        good="signal d_obs\nhard avoid: always (d_obs >= 1)\n",
        kind="shown",
    ),
    Code(
        "D869",
        "transitions that are not known to be deterministic",
        "error",
        message="'{env}' cannot be learned: {reason}",
        help="{help}",
        explanation="The tabular learner works on a table of deterministic transitions over discrete states: "
        "its mask (never take again what once violated) is right only there.",
        bad="# stlspec learn ... --env FrozenLake-v1\n",
        good="# stlspec learn ... --env FrozenLake-v1 --env-arg is_slippery=false\n",
        kind="shown",
    ),
    Code(
        "D870",
        "an environment without a signal that the spec needs",
        "error",
        message="'{env}' does not offer signal '{signal}', which {user} needs",
        help='it offers {offered}; rename the signal, or add `from "NAME"` to its declaration',
        explanation="While learning, signals are computed from the environment's states, not read from data.",
        bad="# signal distance   with stlspec/GridWorld-v0\n",
        good='# signal distance from "d_goal"   with stlspec/GridWorld-v0\n',
        kind="shown",
    ),
    Code(
        "D871",
        "an option of the learner out of range",
        "error",
        message="{option} is {value}, but must be {allowed}",
        help="leave {option} out for its default",
        explanation="Learning has no meaning outside these ranges.",
        bad="# stlspec learn ... --gamma 1.5\n",
        good="# stlspec learn ... --gamma 0.99\n",
        kind="shown",
    ),
    Code(
        "D872",
        "an output that would overwrite something else",
        "error",
        message="'{path}' {problem}",
        help="choose another --out, or remove it first",
        explanation="A run replaces the directory of an earlier run, which it knows by its result.json, and "
        "nothing else.",
        bad="# stlspec learn ... --out src/\n",
        good="# stlspec learn ... --out runs/grid\n",
        kind="shown",
    ),
    Code(
        "D873",
        "a damaged policy",
        "error",
        message="not a usable policy: {problem}",
        help="learn it again: stlspec learn SPEC --env ENV --demos DEMO... --out DIR",
        explanation="policy.json in the output directory of `stlspec learn` has schema stlspec.policy/1: for "
        "every state of the environment the greedy action.",
        bad='{"schema": "stlspec.policy/1", "states": [[0, 0]], "actions": [7]}',
        good='{"schema": "stlspec.policy/1", "env": {...}, "n_actions": 4, "states": [[0, 0]], '
        '"actions": [2], "q": [[0, 0, 0, 0]]}',
        kind="shown",
    ),
    Code(
        "D874",
        "an observation that is no state of the policy",
        "error",
        message="{observation} is not a state of this policy, which knows {states} states",
        help="pass the observation of the environment that the policy was learned in: {example}",
        explanation="A tabular policy has an action for every state of its environment, and no others.",
        bad="policy.act([99, 99])\n",
        good="policy.act([0, 0])\n",
        kind="shown",
    ),
    Code(
        "D875",
        "states of an unknown environment",
        "error",
        message="demonstration '{name}' has states, but no environment says which they are",
        help='name the environment: --env ID, or "env": {{"id": ...}} in the demonstration; states that '
        "are raw observations cannot be given rewards yet",
        explanation="Rewards are values of an environment's discrete states: [row, col] on a map, or a number.",
        bad="# stlspec reward spec.stl demo.json   where demo.json has states and no env\n",
        good="# stlspec reward spec.stl demo.json --env stlspec/GridWorld-v0 --map grid.txt\n",
        kind="shown",
    ),
)
"""Codes of this stage."""
