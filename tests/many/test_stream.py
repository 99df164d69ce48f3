"""A stream is scored as a file of the same text is."""

import io

import numpy as np
import pytest

from stlspec import api
from stlspec.demos import load_demonstrations
from stlspec.errors import DataError, UsageError
from stlspec.many.stream import score_stream
from stlspec.readers import stream as reading
from stlspec.scores import score
from stlspec.semantics.streaming import stream as engine

SPEC = """time 10 ms
signal height from "z"
signal x in [-9, 9]
signal ok: bool
hard up: always (height > -3)
soft far depends on up scale 2: eventually (x > 2.5)
soft answer: always (x > 1 implies eventually[0, 100 ms] (height > 0))
soft seen: always (ok implies once (x > 1))
soft stay: (height > -3) until[50 ms, 2 s] (x > 1.5)
soft gone: always[1 h, 2 h] (x > 0)
"""


@pytest.fixture
def text():
    rng = np.random.default_rng(3)
    rows = np.round(rng.normal(size=(500, 2)), 1)
    lines = [f"{10 * k},{x},note,{'true' if x > z else '0'},{z}" for k, (x, z) in enumerate(rows.tolist())]
    return "time,x,words,ok,z\n" + "\n".join(lines) + "\n"


def both(text, tmp_path, **options):
    file = tmp_path / "d.csv"
    file.write_text(text)
    bundle = api.compile(SPEC)
    whole = score(bundle, load_demonstrations(file), **options)
    return whole, score_stream(bundle, io.BytesIO(text.encode()), name=str(file), **options)


@pytest.mark.parametrize("size", [300, 2**22])
def test_the_document_is_that_of_the_file(text, size, tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "BLOCK_BYTES", size)
    monkeypatch.setattr(engine, "BLOCK", 16)
    monkeypatch.setattr(engine.Stream.__init__, "__defaults__", (None, 16))
    whole, found = both(text, tmp_path)
    assert found.to_json() == whole.to_json()
    reasons = [[r.reason for r in d.demonstrations[0].requirements.values()] for d in (whole, found)]
    assert reasons[0] == reasons[1] and any(reasons[0])


@pytest.mark.parametrize("on_nan", ["hold", "drop"])
def test_holes_are_treated_as_in_a_file(text, on_nan, tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "BLOCK_BYTES", 100)
    lines = text.splitlines()
    for k in (5, 6, 7, 30, 300):
        parts = lines[k].split(",")
        lines[k] = ",".join([parts[0], "nan" if k != 30 else parts[1], *parts[2:4], "" if k == 30 else parts[4]])
    whole, found = both("\n".join(lines) + "\n", tmp_path, on_nan=on_nan)
    assert found.to_json() == whole.to_json()


def refused(text, spec=SPEC, **options):
    with pytest.raises((DataError, UsageError)) as caught:
        score_stream(api.compile(spec), io.BytesIO(text.encode()), **options)
    return [(d.code, d.file) for d in caught.value.diagnostics]


def test_what_is_missing_or_broken_is_named(text):
    assert refused(text.replace("words,ok,z", "words,okay,zed")) == [("D804", "<stdin>"), ("D804", "<stdin>")]
    assert refused(text.replace(",note,", ",note,x,", 1)) == [("D834", "<stdin>")]
    assert refused("time,x,ok,z\n") == [("D803", "<stdin>")]
    assert refused("time,x,ok,z\n0,nan,1,1\n", on_nan="drop") == [("D803", "<stdin>")]
    assert refused("time,x,ok,z\n0,nan,1,1\n", on_nan="hold") == [("D801", "<stdin>")]
    assert refused(text, on_nan="guess") == [("D880", None)]
    assert refused(text, "signal x\nhard r: always eventually (x > 0)\n") == [("D896", None)]
