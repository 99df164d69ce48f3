"""D885 to D887: recording demonstrations."""

from stlspec.errors.model import Code

CODES: tuple[Code, ...] = (
    Code(
        "D885",
        "an environment that cannot be recorded",
        "error",
        message="'{id}' cannot be recorded: {reason}",
        help="{help}",
        explanation="`stlspec record` takes environments with a finite set of actions (each gets a key). Maps are "
        "drawn by the page itself; other environments show the frames that they render, for which gymnasium's own "
        "need pygame.",
        bad="# stlspec record --env Pendulum-v1 -o swing.jsonl",
        good="# stlspec record --env MountainCar-v0 -o drive.jsonl",
        kind="shown",
    ),
    Code(
        "D886",
        "a recording that cannot be saved there",
        "error",
        message="{problem}",
        help="{help}",
        explanation="Recordings are saved as .jsonl or .json. A file that holds demonstrations already is added to, "
        "never replaced; one that something else changes during the recording is left alone.",
        bad="# stlspec record --env FrozenLake-v1 -o demo.csv",
        good="# stlspec record --env FrozenLake-v1 -o demo.jsonl",
        kind="shown",
    ),
    Code(
        "D887",
        "a page that cannot be served",
        "error",
        message="the page cannot be served at port {port}: {problem}",
        help="leave out `--port` for any port that is free, or choose another one",
        explanation="The recorder serves its page on the loopback address of this machine only. A port can be "
        "taken by another program, and those below 1024 need privileges.",
        bad="# stlspec record --env FrozenLake-v1 -o demo.jsonl --port 80",
        good="# stlspec record --env FrozenLake-v1 -o demo.jsonl --port 8765",
        kind="shown",
    ),
)
