"""The bundle as a file: one canonical JSON document, the same bytes wherever it is built.

In: `BundleData`. Out: bytes, and back. Reading executes nothing and trusts nothing: size, JSON, version,
structure and both hashes are checked, and derived parts (weights, horizons) are computed again.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from operator import attrgetter
from pathlib import Path, PurePath
from types import MappingProxyType
from typing import Any

from stlspec.compiler.bundle import BundleData, Param, Requirement, Signal, TimeBase
from stlspec.compiler.dependencies import ancestors, dependency_weights, find_cycle, softmax
from stlspec.compiler.horizon import horizons
from stlspec.compiler.ir import Node
from stlspec.compiler.structure import (
    Malformed,
    Reader,
    check_names,
    check_nodes,
    check_requirements,
    check_signals,
    check_time,
)
from stlspec.errors import BundleError, diagnostic

SCHEMA = "stlspec.bundle/1"
LANGUAGE = 1
LARGEST = 64 * 2**20
Json = dict[str, Any]


def number(value: float) -> float | str:
    """Return a number as JSON has it: finite, or the text "inf" or "-inf"."""
    return value if abs(value) != float("inf") else ("inf" if value > 0 else "-inf")


def _optional(value: float | None) -> float | str | None:
    return None if value is None else number(value)


def _canonical(document: Any) -> bytes:
    text = json.dumps(document, sort_keys=True, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.encode("utf-8")


def _sha256(document: Any) -> str:
    return hashlib.sha256(_canonical(document)).hexdigest()


def _node(node: Node) -> Json:
    entry: Json = {"op": node.op}
    if node.children:
        entry["children"] = list(node.children)
    if node.value is not None:
        entry["value"] = node.value if isinstance(node.value, str) else number(node.value)
    if node.interval is not None:
        entry["interval"] = list(node.interval)
    return entry


def _meaning(bundle: BundleData) -> Json:
    """Return what decides whether two specs are the same: no text, no file names, no docs."""
    time = bundle.time
    return {
        "time": [time.kind, time.unit, time.ticks_per_unit, time.period],
        "signals": [
            [s.name, s.type, s.unit, _optional(s.low), _optional(s.high), s.source]
            for s in sorted(bundle.signals, key=attrgetter("name"))
        ],
        "params": [[p.name, number(p.value), p.unit] for p in sorted(bundle.params, key=attrgetter("name"))],
        "requirements": [
            [r.name, r.strength, number(r.scale), r.bound, r.root, sorted(r.depends_on)] for r in bundle.requirements
        ],
        "nodes": [_node(node) for node in bundle.nodes],
        "weights": list(bundle.raw_weights),
    }


def meaning_sha256(bundle: BundleData) -> str:
    """Return the hash that alone decides "the same spec"."""
    return _sha256(_meaning(bundle))


def source_sha256(bundle: BundleData) -> str:
    """Return the hash of the texts that the bundle was compiled from.

    It covers what was taken from them as it stands, too: title, docs, formulas, names of lets are no meaning,
    but people read them.
    """
    declared: tuple[Signal | Param | Requirement, ...] = (*bundle.signals, *bundle.params, *bundle.requirements)
    return _sha256(
        {
            "sources": _sources(bundle),
            "title": [bundle.name, bundle.title],
            "docs": [part.doc for part in declared],
            "formulas": [r.text for r in bundle.requirements],
            "lets": dict(bundle.names),
        }
    )


def _sources(bundle: BundleData) -> list[Json]:
    """Return the texts, under names relative to the main file."""
    return [{"file": name if i else PurePath(name).name, "text": text} for i, (name, text) in enumerate(bundle.sources)]


def schema_text() -> str:
    """Return the JSON Schema of the bundle file, as it ships with the package."""
    return Path(__file__).with_name("bundle.schema.json").read_text(encoding="utf-8")


def dump(bundle: BundleData) -> bytes:
    """Write a bundle as canonical JSON with a line end."""
    return _canonical(_written(bundle)) + b"\n"


def _written(bundle: BundleData) -> Json:
    return {
        "schema": SCHEMA,
        "language": LANGUAGE,
        "meaning_sha256": meaning_sha256(bundle),
        "source_sha256": source_sha256(bundle),
        "name": bundle.name,
        "title": bundle.title,
        "time": asdict(bundle.time),
        "signals": [{**asdict(s), "low": _optional(s.low), "high": _optional(s.high)} for s in bundle.signals],
        "params": [{**asdict(p), "value": number(p.value)} for p in bundle.params],
        "requirements": [
            {**asdict(r), "depends_on": list(r.depends_on), "raw_weight": raw, "weight": weight}
            for r, raw, weight in zip(bundle.requirements, bundle.raw_weights, bundle.weights, strict=True)
        ],
        "edges": [list(edge) for edge in bundle.edges],
        "nodes": [_node(node) for node in bundle.nodes],
        "names": dict(bundle.names),
        "sources": _sources(bundle),
    }


def load(data: bytes, file: str = "bundle") -> BundleData:
    """Read a bundle.

    Raises: BundleError: B701 no bundle, B702 another version, B703 changed, B704 not well formed.
    """
    document = _document(data, file)
    for what, known in (("schema", SCHEMA), ("language", LANGUAGE)):
        if document.get(what) != known:
            value = document.get(what)
            found = repr(value)[:40] if isinstance(value, str | int | None) else f"a {type(value).__name__}"
            raise BundleError([diagnostic("B702", file=file, what=what, found=found, known=known)])
    try:
        bundle = _bundle(Reader(document, "the bundle"))
    except Malformed as error:
        raise BundleError([diagnostic("B704", file=file, problem=str(error))]) from None
    for what, computed in (("meaning_sha256", meaning_sha256), ("source_sha256", source_sha256)):
        if document.get(what) != computed(bundle):
            raise BundleError([diagnostic("B703", file=file, what=what)])
    if not _is_same(document, bundle):
        raise BundleError([diagnostic("B703", file=file, what="content")])
    return bundle


def _is_same(document: Json, bundle: BundleData) -> bool:
    """Tell whether a document says what the bundle made of it, byte for byte but for blanks."""
    try:
        return _canonical(document) == _canonical(_written(bundle))
    except (ValueError, RecursionError):
        return False


def _once(pairs: Sequence[tuple[str, Any]]) -> Json:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError("a key is given twice")
    return found


def _document(data: bytes, file: str) -> Json:
    problem = ""
    document: Any = None
    if len(data) > LARGEST:
        problem = f"it has {len(data)} bytes, more than {LARGEST}"
    else:
        try:
            document = json.loads(data.decode("utf-8"), object_pairs_hook=_once)
        except UnicodeDecodeError:
            problem = "it is not UTF-8 text"
        except RecursionError:
            problem = "it is nested too deep"
        except ValueError as error:
            problem = f"it is not JSON ({str(error)[:80]})"
    if not problem and (not isinstance(document, dict) or "schema" not in document):
        problem = "it has no `schema`"
    if problem:
        raise BundleError([diagnostic("B701", file=file, problem=problem)])
    return dict(document)


def _bundle(top: Reader) -> BundleData:
    nodes = tuple(_read_node(entry) for entry in top.entries("nodes"))
    signals = tuple(_read_signal(entry) for entry in top.entries("signals"))
    check_nodes(nodes, {s.name: s.type for s in signals})
    time = _read_time(top.entry("time"))
    ahead = horizons(nodes, time)
    requirements = tuple(_read_requirement(entry, ahead) for entry in top.entries("requirements"))
    params = tuple(_read_param(entry) for entry in top.entries("params"))
    names = top.entry("names")
    check_names([s.name for s in signals], [p.name for p in params], [r.name for r in requirements], list(names.values))
    check_signals(signals)
    check_requirements(requirements, nodes)
    edges = {r.name: r.depends_on for r in requirements}
    if find_cycle(edges):
        raise Malformed("its requirements depend on each other in a circle")
    raw = dependency_weights(list(ancestors(edges).values()))
    return BundleData(
        name=top.name("name") if top.values.get("name") else top.text("name"),
        title=top.optional_text("title"),
        time=time,
        signals=signals,
        params=params,
        requirements=requirements,
        nodes=nodes,
        names=MappingProxyType({name: names.index(name, len(nodes)) for name in names.values}),
        raw_weights=raw,
        weights=softmax(raw),
        sources=_read_sources(top),
    )


def _read_sources(top: Reader) -> tuple[tuple[str, str], ...]:
    sources = tuple((entry.text("file"), entry.text("text")) for entry in top.entries("sources"))
    if not sources:
        raise Malformed("it has no source")
    return sources


def _read_time(entry: Reader) -> TimeBase:
    kind = entry.choice("kind", ("step", "period", "stamps"))
    period = entry.whole("period", 1, 2**62) if entry.values.get("period") is not None else None
    time = TimeBase(kind, entry.text("unit"), entry.whole("ticks_per_unit", 1, 2**62), period)  # type: ignore[arg-type]
    check_time(time)
    return time


def _read_signal(entry: Reader) -> Signal:
    return Signal(
        entry.name("name"),
        entry.choice("type", ("real", "bool")),  # type: ignore[arg-type]
        entry.optional_text("unit"),
        entry.optional_number("low"),
        entry.optional_number("high"),
        entry.optional_text("source"),
        entry.optional_text("doc"),
    )


def _read_param(entry: Reader) -> Param:
    return Param(entry.name("name"), entry.number("value"), entry.optional_text("unit"), entry.optional_text("doc"))


def _read_requirement(entry: Reader, ahead: tuple[int | None, ...]) -> Requirement:
    root = entry.index("root", len(ahead))
    scale = entry.number("scale")
    if not 0 < scale < float("inf"):
        raise Malformed("a scale is not positive")
    return Requirement(
        name=entry.name("name"),
        strength=entry.choice("strength", ("hard", "soft")),  # type: ignore[arg-type]
        root=root,
        depends_on=tuple(entry.texts("depends_on")),
        scale=scale,
        bound=entry.choice("bound", ("tanh", "linear", "none")),  # type: ignore[arg-type]
        horizon=ahead[root],
        doc=entry.optional_text("doc"),
        text=entry.text("text"),
    )


def _read_node(entry: Reader) -> Node:
    values: Mapping[str, Any] = entry.values
    value = values.get("value")
    interval = None
    if "interval" in values:
        low, high = entry.pair("interval")
        interval = (low, high)
    children = tuple(entry.wholes("children")) if "children" in values else ()
    if value is not None and not (isinstance(value, str) and values.get("op") in ("signal", "bool")):
        value = entry.number("value")
    return Node(entry.text("op"), children, value, interval)
