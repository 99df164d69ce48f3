import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stlspec.errors import DataError
from stlspec.readers.document import decode, numbered, recording_of
from stlspec.readers.model import Recording

FILE = Path("d.json")
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=10,
)
FIELDS = ("schema", "name", "time", "signals", "states", "actions", "env", "episode")


def refused(call, *arguments) -> tuple[str, str]:
    with pytest.raises(DataError) as error:
        call(*arguments)
    (found,) = error.value.diagnostics
    assert found.file == "d.json"
    return found.code, str(error.value)


def test_all_parts_of_a_demonstration_are_read():
    found = recording_of(
        {
            "schema": "stlspec.demo/1",
            "name": "first",
            "time": [0, 0.5],
            "signals": {"x": [1, "-inf"], "ok": [True, False]},
            "states": [[0, 1], [0, 2]],
            "actions": [2],
            "env": {"id": "FrozenLake-v1"},
            "weather": "rain",
        },
        FILE,
    )
    assert found.name == "first" and found.time.tolist() == [0, 0.5]
    assert found.columns["x"].tolist() == [1, -math.inf]
    assert found.columns["ok"].tolist() == [True, False] and found.columns["ok"].dtype == bool
    assert found.states == ([0, 1], [0, 2]) and found.actions == (2,)
    assert found.env == {"id": "FrozenLake-v1"} and found.episode is None


def test_null_and_the_word_nan_are_holes():
    found = recording_of({"signals": {"x": [None, "nan", 1]}}, FILE)
    assert [math.isnan(v) for v in found.columns["x"]] == [True, True, False]


def test_a_word_in_a_signal_is_left_for_the_trace_to_refuse():
    assert recording_of({"signals": {"x": ["5", 1]}}, FILE).columns["x"].tolist() == ["5", 1]


@pytest.mark.parametrize(
    ("document", "code", "words"),
    [
        (3, "D837", "the demonstration is '3', not an object"),
        (None, "D837", "null"),
        ({}, "D837", "an object with nothing, not one with 'signals' or 'states'"),
        ({"signal": {"x": [1]}}, "D837", "an object with 'signal'"),
        ({"schema": "stlspec.score/1", "signals": {"x": [1]}}, "D837", "'stlspec.demo/1'"),
        ({"signals": [1, 2]}, "D837", "'signals' of the demonstration is a list"),
        ({"signals": {"x": 3}}, "D837", "signal 'x' of the demonstration is '3', not a list"),
        ({"signals": {"x": [1, [2]]}}, "D837", "signal 'x' of the demonstration at sample 1 is a list"),
        ({"states": {"a": 1}}, "D837", "'states' of the demonstration is an object"),
        ({"states": [1], "actions": 3}, "D837", "'actions'"),
        ({"states": [1], "env": "FrozenLake-v1"}, "D837", "'env'"),
        ({"states": [1], "name": [1]}, "D837", "'name'"),
        ({"states": [1], "time": "now"}, "D837", "'time'"),
        ({"signals": {}}, "D803", "no samples"),
        ({"signals": {"x": []}}, "D803", "no samples"),
        ({"signals": {"x": [1, 2], "y": [1]}}, "D805", "'y' has 1 sample, but 'x' has 2"),
        ({"signals": {"x": [1, 2]}, "states": [1]}, "D805", "'states' has 1"),
        ({"states": [1, 2], "actions": [0, 0]}, "D839", "2 actions for 2 samples"),
    ],
)
def test_what_is_no_demonstration_is_refused(document, code, words):
    found, text = refused(recording_of, document, FILE)
    assert found == code and words in text


@given(JSON | st.fixed_dictionaries({}, optional=dict.fromkeys(FIELDS, JSON)))
def test_any_value_is_read_or_refused(document):
    try:
        assert recording_of(document, FILE).n_samples > 0
    except DataError as error:
        assert all(d.file == "d.json" for d in error.diagnostics)


def test_pythons_words_for_infinity_are_numbers():
    found = decode('{"a": [NaN, Infinity, -Infinity]}', FILE)["a"]
    assert math.isnan(found[0]) and found[1:] == [math.inf, -math.inf]


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ('{"a": [1,', "D836", "cut off"),
        ('{"a": 1}\n{"a": 2}', "D836", "extra data (line 2, column 1)"),
        ("[" * 200_000, "D836", "nested too deeply"),
        ('{"a":' * 200_000, "D836", "nested too deeply"),
        ("[" + "1" * 5000 + "]", "D836", "a number is too long"),
        ('{"x": 1, "x": 2}', "D835", "the key 'x' comes twice"),
        ("time,x\n0,1\n", "D836", "line 1, column 1"),
    ],
)
def test_what_is_no_json_is_refused_with_its_place(text, code, words):
    found, shown = refused(decode, text, FILE)
    assert found == code and words in shown


def test_a_line_of_a_larger_file_is_named_by_its_number():
    _, shown = refused(decode, "{", FILE, 7)
    assert "line 7, column 2" in shown


def test_several_recordings_are_numbered_from_zero_unless_they_say():
    several = numbered([Recording(), Recording(episode="z"), Recording()])
    assert [each.episode for each in several] == ["0", "z", "2"]
    assert [each.episode for each in numbered([Recording()])] == [None]


def test_whole_time_stamps_keep_every_nanosecond():
    stamps = [1700000000123456789, 1700000000123456790]
    assert recording_of({"time": stamps, "signals": {"x": [1, 2]}}, FILE).time.tolist() == stamps
    assert recording_of({"time": [0, None], "signals": {"x": [1, 2]}}, FILE).time.dtype == np.float64


@pytest.mark.parametrize("text", [r'{"name": "\ud800"}', r'{"a\uDFFF": 1}', r'{"env": {"id": ["\udc00\ud800"]}}'])
def test_half_of_a_surrogate_pair_is_refused(text):
    found, shown = refused(decode, text, FILE, 3)
    assert found == "D836" and "surrogate" in shown and "line 3" in shown


def test_a_whole_surrogate_pair_and_a_backslash_are_characters():
    assert decode(r'{"a": "\ud83d\ude00", "b": "\\ud800", "c": NaN}', FILE)["a"] == "😀"
