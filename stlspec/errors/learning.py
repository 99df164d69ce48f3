"""D858 to D879: scores that cannot be weighed, reward maps, steps, and tasks that the learner cannot take."""

from stlspec.errors.model import Code

CODES: tuple[Code, ...] = (
    Code(
        "D858",
        "a reward map over other bins",
        "error",
        message="the reward map has values for the bins {made}, but '{env}' {now} here",
        help="{help}",
        explanation="Where observations are cut otherwise, the number of a bin means another part of them, so values "
        "that were inferred over some bins cannot be used over others.",
        bad="# stlspec learn ... --env MountainCar-v0 --bins 25,16 --reward R.json  (R.json: 20,20)\n",
        good="# stlspec learn ... --env MountainCar-v0 --bins 20,20 --reward R.json\n",
        kind="shown",
    ),
    Code(
        "D859",
        "a recorded step that the environment cannot take",
        "warning",
        message="demonstration '{name}': sample {sample} to {next} is no step of '{env}': {what}{more}",
        help="{help}",
        explanation="Where an environment knows its transitions, the steps of a demonstration are compared with them; "
        "where they are by chance, with all that can happen. A log that leaves out samples jumps over cells, so that "
        "a violation between them is not seen and time bounds count too few samples: labels can be wrong. The "
        "demonstration is used all the same.",
        bad='{"states": [[0, 0], [0, 2]], "env": {"id": "stlspec/GridWorld-v0", "map": ["S.G"]}}',
        good='{"states": [[0, 0], [0, 1], [0, 2]], "env": {"id": "stlspec/GridWorld-v0", "map": ["S.G"]}}',
        kind="shown",
    ),
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
        message="state {state} of {what} is not a state of '{env}', which has {states} of them",
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
        "too many orders of goals",
        "error",
        message="the {count} goals of the spec can be visited in {orders} orders, and the learner tries at most "
        "{most}: {goals}",
        help="say which comes first, for example: soft order: not b until a",
        explanation="Every distinct condition under an `eventually` is a goal, and the learner tries the orders in "
        "which goals can be visited (Algorithm 3): all of them for up to six goals. `not b until a`, "
        "`eventually (a and eventually b)` and `depends on` leave fewer.",
        bad="# soft all: eventually a and eventually b and ... eventually g   (seven goals: 5,040 orders)\n",
        good="# soft all: eventually (a and eventually (b and ... eventually g))   (one order)\n",
        kind="shown",
    ),
    Code(
        "D868",
        "a hard requirement that the learner cannot watch step by step",
        "error",
        message="hard requirement '{requirement}' cannot be watched while the policy is learned: {reason}",
        help="write it as `hard {requirement}: always (...)` over the present and the past, or make it soft",
        explanation="The learner watches hard requirements at every step. One with memory runs beside the "
        "environment as a machine with finitely many states, so a past operator may not stand over a future "
        "one, nor delta or rate over another or beside `now`, nor may what is left to demand grow with every sample.",
        bad="signal x\nhard odd: always (once (eventually (x > 1)))\n",
        good="signal x\nhard fine: always (once[0, 5] (x > 1))\n",
        kind="shown",
    ),
    Code(
        "D878",
        "too many states to learn over",
        "error",
        message="the {places} states of the environment, times what the hard requirements remember, are more than "
        "{most} states",
        help="shorten the windows in the hard requirements, or make one of them soft",
        explanation="A hard requirement with memory (a past operator, bounds, `until`, `now`) makes the learner "
        "tell states apart by what happened before: one for each state of the environment and of the "
        "requirement's timers that can be reached.",
        bad="# hard slow: always (once[0, 100000] wet implies not dry)\n",
        good="# hard quick: always (once[0, 5] wet implies not dry)\n",
        kind="shown",
    ),
    Code(
        "D869",
        "an environment that the learner has no table for",
        "error",
        message="'{env}' cannot be learned: {reason}",
        help="{help}",
        explanation="The tabular learner has a value for every state and action: states are discrete, or flat "
        "observations that `--bins` cuts into bins; actions are Discrete. Several goals and hard requirements "
        "with memory need a table of deterministic transitions.",
        bad="# stlspec learn ... --env MountainCar-v0\n",
        good="# stlspec learn ... --env MountainCar-v0 --bins 50,50\n",
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
        message="{observation} is not a state of this policy, which knows {states} of them",
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
        message="demonstration '{name}' has states, but {reason}",
        help="{help}",
        explanation="Rewards are values of an environment's discrete states: [row, col] on a map, or a number.",
        bad="# stlspec reward spec.stl demo.json   where demo.json has states and no env\n",
        good="# stlspec reward spec.stl demo.json --env stlspec/GridWorld-v0 --map grid.txt\n",
        kind="shown",
    ),
    Code(
        "D876",
        "a spec in stamps to learn from",
        "error",
        message="a policy takes steps, but the spec measures stamps",
        help="use `time step`, or a period such as `time 100 ms`",
        explanation="Training has no clock: a sample of a learned path is a step in the environment. With `time s` "
        "every sample has a stamp of its own, and only data can say which.",
        bad="time s\nsignal d_goal\nsoft reach: eventually[0 s, 5 s] (d_goal < 1)\n",
        good="time 100 ms\nsignal d_goal\nsoft reach: eventually[0 s, 5 s] (d_goal < 1)\n",
        kind="shown",
    ),
    Code(
        "D879",
        "a step of an environment without what a signal is read from",
        "error",
        message="'{env}' gives nothing to read signal '{signal}' from: {reason}",
        help='look at one step of it: `from "obs[0]"`, `from "obs.key[1]"`, `from "info.speed"`, `from "action[0]"`',
        explanation="A signal with `from` is read from the observation, the info or the action of every step, the "
        "first one included, which has an info of its own.",
        bad='signal speed from "info.velocity"  # an environment whose info is empty\n',
        good='signal speed from "obs[1]"\n',
        kind="shown",
    ),
    Code(
        "D877",
        "a picture that could not be drawn",
        "warning",
        message="the picture {picture} could not be drawn: {problem}",
        help="all other files of the run are there; without matplotlib the reward map is drawn as text",
        explanation="Pictures are drawn by matplotlib, from the results. A run is not lost with its pictures.",
        bad="# a broken installation of matplotlib\n",
        good="# pip install --force-reinstall matplotlib\n",
        kind="shown",
    ),
)
"""Codes of this stage."""
