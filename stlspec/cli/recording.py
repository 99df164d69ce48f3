"""The command record: demonstrations by pointing and clicking.

In: an environment, and a spec if there is one. Out: a demonstration file. The URL of the page goes to stderr; what
was saved goes to stdout when it is over.
"""

import sys
from pathlib import Path
from typing import Annotated

import typer

from stlspec.cli.data import EnvArgs, MapOption, environment_from
from stlspec.cli.options import FormatOption, Params, read_params
from stlspec.cli.output import Format, print_json


def record(
    env: Annotated[str, typer.Option("--env", metavar="ID", help="the environment, by gymnasium id")],
    out: Annotated[
        Path, typer.Option("--output", "-o", metavar="DEMO", help="a .jsonl or .json file; added to if it exists")
    ],
    spec: Annotated[
        Path | None, typer.Argument(metavar="SPEC", help="a spec to watch while recording, or a bundle")
    ] = None,
    params: Params = None,
    env_arg: EnvArgs = None,
    map_file: MapOption = None,
    port: Annotated[int, typer.Option("--port", min=0, max=65535, help="of the page; 0: any that is free")] = 0,
    seed: Annotated[int, typer.Option("--seed", min=0, help="of the first episode; each one has its own")] = 0,
    open_page: Annotated[bool, typer.Option("--open", help="open the page in the browser of this machine")] = False,
    output: FormatOption = Format.TEXT,
) -> None:
    """Record demonstrations in a browser, with the requirements of a spec live beside them."""
    from stlspec import api
    from stlspec.tools.record.recording import record as run

    bundle = api.read(spec, read_params(params)) if spec is not None else None
    environment = environment_from(env, env_arg, map_file)
    assert environment is not None

    def ready(url: str) -> None:
        print(f"recording at {url}", file=sys.stderr)
        print("this page is served to this machine only; Ctrl-C ends it and keeps what was recorded", file=sys.stderr)
        sys.stderr.flush()
        if open_page:
            typer.launch(url)

    recorded = run(bundle, environment, out, port=port, seed=seed, ready=ready)
    if recorded.interrupted:
        print(recorded.account, file=sys.stderr)
        raise KeyboardInterrupt
    if output is Format.JSON:
        print_json(recorded.to_json())
    else:
        print(recorded.account)
