"""The commands on specs themselves: explain, compile, graph.

In: spec files. Out: diagnostics, bundles, the DAG. `check` and `explain` load nothing heavy.
"""

from difflib import get_close_matches
from pathlib import Path
from textwrap import fill
from typing import Annotated

import typer

from stlspec.cli.options import FormatOption, Params, read_params, spare_inputs
from stlspec.cli.output import Format, GraphFormat, print_json
from stlspec.compiler import bundle_file, files
from stlspec.compiler.printing import counted
from stlspec.errors import CATALOGUE, UsageError, diagnostic


def explain(
    code: Annotated[
        str | None, typer.Argument(metavar="CODE", help="such as I401, or how several begin: I4; all codes if left out")
    ] = None,
    output: FormatOption = Format.TEXT,
) -> None:
    """Say what a diagnostic code means, with a bad and a good example."""
    beginning = (code or "").upper()
    several = [row for row in CATALOGUE.values() if row.code.startswith(beginning)]
    if several and beginning not in CATALOGUE:
        rows = [{"code": row.code, "title": row.title, "level": row.level} for row in several]
        if output is Format.JSON:
            print_json({"schema": "stlspec.explain/1", "codes": rows})
        else:
            print("\n".join(f"{row['code']}  {row['level']:<8} {row['title']}" for row in rows))
        return
    row = CATALOGUE.get(beginning)
    if row is None:
        close = get_close_matches(beginning, CATALOGUE, 1, 0.6)
        way = f"did you mean `{close[0]}`?" if close else "`stlspec explain` lists all codes"
        raise UsageError([diagnostic("D880", what=f"there is no code `{code}`", help=way)])
    if output is Format.JSON:
        keys = ("code", "title", "level", "explanation", "bad", "good")
        print_json({"schema": "stlspec.explain/1", **{key: getattr(row, key) for key in keys}})
        return
    print(f"{row.code} ({row.level}): {row.title}\n\n{_wrapped(row.explanation)}\n")
    print(f"Bad:\n{_indented(row.bad)}\n\nGood:\n{_indented(row.good)}")


def _wrapped(text: str, width: int = 88) -> str:
    return fill(text, width)


def _indented(text: str) -> str:
    return "\n".join(f"    {line[:120]}" for line in text.rstrip("\n").split("\n"))


def compile_spec(
    spec: Annotated[Path, typer.Argument(metavar="FILE", help="a spec file")],
    out: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="the bundle to write")],
    params: Params = None,
    output: FormatOption = Format.TEXT,
) -> None:
    """Compile a spec into a bundle, which other commands take in place of the spec."""
    spare_inputs(out, [spec])
    bundle = files.read_spec(spec, read_params(params))
    files.write_bytes(out, bundle_file.dump(bundle))
    meaning = bundle_file.meaning_sha256(bundle)
    if output is Format.JSON:
        source = bundle_file.source_sha256(bundle)
        print_json(
            {
                "schema": "stlspec.compile/1",
                "file": str(out),
                "meaning_sha256": meaning,
                "source_sha256": source,
            }
        )
    else:
        print(f"{out}: {counted(len(bundle.requirements), 'requirement')}, meaning {meaning[:12]}")


def graph(
    spec: Annotated[Path, typer.Argument(metavar="SPEC", help="a spec file or a bundle")],
    params: Params = None,
    output: Annotated[GraphFormat, typer.Option("--format", help="how to draw it")] = GraphFormat.TEXT,
) -> None:
    """Draw the DAG of requirements with their weights."""
    from stlspec.compiler import graph as drawing

    bundle = files.read_spec(spec, read_params(params))
    if output is GraphFormat.JSON:
        rows = zip(bundle.requirements, bundle.raw_weights, bundle.weights, strict=True)
        nodes = [{"name": r.name, "strength": r.strength, "raw_weight": raw, "weight": w} for r, raw, w in rows]
        print_json({"schema": "stlspec.graph/1", "requirements": nodes, "edges": [list(e) for e in bundle.edges]})
        return
    draw = {
        GraphFormat.TEXT: drawing.tree_text,
        GraphFormat.MERMAID: drawing.mermaid_text,
        GraphFormat.DOT: drawing.dot_text,
    }
    print(draw[output](bundle))
