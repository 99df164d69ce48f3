"""The bundle as a file: canonical, checked, and never trusted."""

import copy
import json
import math

import jsonschema
import pytest

from stlspec.compiler import bundle_file
from stlspec.compiler.bundle_file import dump, load, meaning_sha256, schema_text, source_sha256
from stlspec.compiler.compiling import compile_source
from stlspec.errors import BundleError
from stlspec.source import SourceText

TEXT = """spec car "Keep a safe distance"   # a comment
time 100 ms
signal gap unit "m" in [0, inf] from "obs.gap[0]" "distance"
signal brake: bool
param T = 1.5 s "time to react"
param far
let close = gap < 10 m
hard keep "doc": always (close implies eventually[0, T] not close)
hard stop depends on keep scale 2 bound linear: always (gap < far)
soft smooth depends on keep, stop: G (close or brake)
"""


def compiled(text=TEXT, name="folder/car.stl", params=None):
    endless = {"far": "inf"} if "param far" in text else {}
    return compile_source(SourceText.of(name, text), {**endless, **(params or {})})


def meaning(text, params=None):
    return meaning_sha256(compiled(text, params=params))


DATA = dump(compiled())
DOCUMENT = json.loads(DATA)
VALIDATOR = jsonschema.Draft202012Validator(json.loads(schema_text()))


def code_of(data):
    """The one B7xx code that loading gives."""
    with pytest.raises(BundleError) as caught:
        load(data, "x.stlb")
    (problem,) = caught.value.diagnostics
    assert problem.code.startswith("B7") and caught.value.exit_code == 2
    return problem.code


def changed(**fields):
    return json.dumps({**DOCUMENT, **fields}).encode()


def test_a_bundle_comes_back_equal_but_for_the_folder_of_its_source():
    bundle = compiled()
    back = load(dump(bundle))
    assert back == compiled(name="car.stl")
    assert dump(back) == dump(bundle) == DATA


def test_the_file_is_canonical_json_with_a_line_end():
    assert json.dumps(DOCUMENT, sort_keys=True, ensure_ascii=False, separators=(",", ":")).encode() + b"\n" == DATA
    assert DOCUMENT["sources"] == [{"file": "car.stl", "text": TEXT}]
    assert (DOCUMENT["params"][1]["value"], DOCUMENT["signals"][0]["high"]) == ("inf", "inf")


def test_blanks_between_tokens_are_no_tampering():
    assert load(json.dumps(DOCUMENT, indent=2).encode()) == load(DATA)


@pytest.mark.parametrize(
    "text",
    [
        TEXT,
        'signal x\nhard a: x > -0.0 and x < 1e308 and x > 5e-324',
        'time us\nsignal x "ü 日本 \\ n"\nhard a: once[0, 5 us] x > 1 since[1 us, 1 h] x < 2',
        "signal x\nsignal b: bool\nhard a: (b until x ** 2 > min(x, now, 3)) xor prev next b\n"
        "soft c: rate(x) + delta(x) > hypot(x, 1)",
    ],
)  # fmt: skip
def test_every_dump_is_valid_under_the_schema_that_ships(text):
    jsonschema.Draft202012Validator.check_schema(VALIDATOR.schema)
    data = dump(compiled(text))
    VALIDATOR.validate(json.loads(data))
    assert dump(load(data)) == data


def test_the_schema_refuses_unknown_fields_and_wrong_types():
    for field, value in (("extra", 1), ("nodes", {}), ("name", "a b"), ("language", 2)):
        assert not VALIDATOR.is_valid({**DOCUMENT, field: value})


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("# a comment", "# another"),
        ("always (close", "always(\n  close"),
        ("G (close", "always (close"),
        ("let close = gap < 10 m\n", "let near = gap < 10 m\nlet close = near\n"),
        ('"distance"', '"how far"'),
        ('"doc"', ""),
        ('spec car "Keep a safe distance"', "spec car2"),
        ("keep, stop:", "stop, keep:"),
        ("1.5 s", "1.50 s"),
        ("signal gap", "signal gap"),
    ],
)
def test_text_names_of_lets_and_docs_do_not_change_the_meaning(before, after):
    assert before in TEXT
    assert meaning(TEXT.replace(before, after)) == meaning(TEXT)


def test_renaming_a_let_keeps_the_meaning_and_changes_the_source():
    renamed = TEXT.replace("close", "near")
    assert meaning(renamed) == meaning(TEXT)
    assert source_sha256(compiled(renamed)) != source_sha256(compiled())


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("< 10 m", "< 11 m"),
        ("< 10 m", "<= 10 m"),
        ("1.5 s", "1.6 s"),
        ("[0, T]", "[100 ms, T]"),
        ("depends on keep, stop", "depends on keep"),
        ("scale 2", "scale 3"),
        ("bound linear", "bound none"),
        ("100 ms", "50 ms"),
        ('unit "m"', 'unit "km"'),
        ("[0, inf]", "[0, 100]"),
        ('from "obs.gap[0]"', 'from "obs.gap[1]"'),
        ("soft smooth", "hard smooth"),
        ("soft smooth", "soft calm"),
        ("signal brake", "signal more\nsignal brake"),
    ],
)
def test_what_a_spec_says_changes_the_meaning(before, after):
    assert before in TEXT
    text = TEXT.replace(before, after)
    assert meaning(text.replace("10 m\n", "10 km\n") if "km" in after else text) != meaning(TEXT)


def test_the_value_of_a_param_is_part_of_the_meaning_wherever_it_came_from():
    assert meaning(TEXT, {"T": 2}) != meaning(TEXT)
    assert meaning(TEXT, {"T": "2000ms"}) == meaning(TEXT.replace("1.5 s", "2 s"))


def test_truncated_anywhere_it_is_refused():
    for end in range(len(DATA) - 1):
        assert code_of(DATA[:end]) == "B701"


def leaves(value, path=()):
    """All paths to values that hold no others, and to all lists and objects."""
    if path:
        yield path
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, (*path, key))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from leaves(inner, (*path, i))


def replaced(path, value):
    document = copy.deepcopy(DOCUMENT)
    inner = document
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    return document


def deleted(path):
    document = copy.deepcopy(DOCUMENT)
    inner = document
    for key in path[:-1]:
        inner = inner[key]
    del inner[path[-1]]
    return document


STRANGE = [None, True, 0, 1, -1, 1.0, 2**70, 1e308, "", "x", "inf", "\ud800", [], {}, [[]], math.nan, math.inf]


def test_every_single_change_of_a_field_is_refused_and_never_another_exception():
    for path in leaves(DOCUMENT):
        old = DOCUMENT
        for key in path:
            old = old[key]
        for new in STRANGE:
            if json.dumps(new) != json.dumps(old):
                code_of(json.dumps(replaced(path, new)).encode())
        code_of(json.dumps(deleted(path)).encode())


def test_with_hashes_made_to_fit_what_is_loaded_is_written_again_as_it_stands(monkeypatch):
    zeros = "0" * 64
    monkeypatch.setattr(bundle_file, "meaning_sha256", lambda bundle: zeros)
    monkeypatch.setattr(bundle_file, "source_sha256", lambda bundle: zeros)
    hashes = {"meaning_sha256": zeros, "source_sha256": zeros}
    refused = 0
    for path in leaves({k: v for k, v in DOCUMENT.items() if k not in hashes}):
        for new in STRANGE:
            data = json.dumps({**replaced(path, new), **hashes}).encode()
            try:
                assert json.loads(dump(load(data))) == json.loads(data)
            except BundleError:
                refused += 1
    assert refused > 2000


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (b"", "B701"),
        (b"[]", "B701"),
        (b"{}", "B701"),
        (b"\xff\xfe", "B701"),
        (b'{"schema": "stlspec.bundle/1", "schema": "stlspec.bundle/1"}', "B701"),
        (b'{"schema": ' + b"[" * 100_000, "B701"),
        (b'{"schema": ' + b"9" * 5000 + b"}", "B701"),
        (b'{"schema": ' + b"[" * 900 + b"]" * 900 + b"}", "B702"),
        (b'{"schema": "stlspec.bundle/99"}', "B702"),
        (b'{"schema": "stlspec.bundle/1", "language": 2}', "B702"),
        (b'{"schema": "stlspec.bundle/1", "language": 1}', "B704"),
        (changed(language=True), "B703"),
        (changed(extra=1), "B703"),
        (changed(extra=math.nan), "B703"),
        (changed(meaning_sha256="0" * 64), "B703"),
        (changed(requirements=[]), "B704"),
        (changed(requirements=DOCUMENT["requirements"] * 2), "B704"),
        (changed(signals=DOCUMENT["signals"] * 2), "B704"),
        (changed(sources=[]), "B704"),
        (changed(names={"keep": 0}), "B704"),
        (changed(names={"a b": 0}), "B704"),
    ],
)  # fmt: skip
def test_foreign_damaged_and_hostile_files_have_their_code(data, code):
    assert code_of(data) == code


def test_a_circle_of_requirements_or_of_nodes_is_refused():
    requirements = copy.deepcopy(DOCUMENT["requirements"])
    requirements[0]["depends_on"] = ["stop"]
    assert code_of(changed(requirements=requirements)) == "B704"
    nodes = copy.deepcopy(DOCUMENT["nodes"])
    nodes[2]["children"] = [2, 1]
    assert code_of(changed(nodes=nodes)) == "B704"


def test_a_file_larger_than_the_limit_is_refused_unread(monkeypatch):
    monkeypatch.setattr(bundle_file, "LARGEST", 100)
    assert code_of(DATA) == "B701"


def test_a_name_that_no_file_can_hold_does_not_break_writing():
    assert b"folder" not in dump(compiled(name="folder/\udcff.stl"))
