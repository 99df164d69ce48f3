"""Horizons beside the lengths of demonstrations."""

import pytest

from stlspec.compiler.compiling import check_source, compile_source
from stlspec.errors import DataError
from stlspec.source import SourceText
from stlspec.tools.coverage import uncovered


def messages(text, demos):
    source = SourceText.of("s", text)
    found = uncovered(source, compile_source(source), check_source(source).model, [str(d) for d in demos])
    return [d.message for d in found]


def test_a_horizon_that_some_demonstrations_do_not_reach_is_named(tmp_path):
    for name, n in (("short.csv", 4), ("long.csv", 9)):
        (tmp_path / name).write_text("x\n" + "1\n" * n)
    text = "signal x\nhard a: always[0, 5] (x > 0)\nhard b: always (x > 0)\nhard c: always[0, 3] (x > 0)\n"
    demos = [tmp_path / "short.csv", tmp_path / "long.csv"]
    assert messages(text, demos) == [
        "`a` looks 5 ahead, further than 1 of 2 demonstrations reach; the shortest lasts 3"
    ]
    assert messages(text, demos[1:]) == []


def test_lengths_are_measured_in_time(tmp_path):
    (tmp_path / "d.csv").write_text("time,x\n0,1\n1.5,1\n")
    (said,) = messages("time s\nsignal x\nhard a: always[0, 2 s] (x > 0)\n", [tmp_path / "d.csv"])
    assert "looks 2 s ahead" in said and "lasts 1.5 s" in said


def test_a_demonstration_that_cannot_be_read_is_refused(tmp_path):
    (tmp_path / "d.csv").write_text("x\n")
    with pytest.raises(DataError):
        messages("signal x\nhard a: always[0, 2] (x > 0)\n", [tmp_path / "d.csv"])


def test_signals_that_a_demonstration_lacks_are_said_as_score_says_them(tmp_path):
    (tmp_path / "d.csv").write_text("altitude\n1\n2\n")
    (tmp_path / "good.csv").write_text("alt,x\n1,1\n2,2\n")
    source = SourceText.of("s", "signal alt\nsignal x\nhard a: always[0, 5] (alt > 0 and x < 3)\n")
    demos = [str(tmp_path / "d.csv"), str(tmp_path / "good.csv")]
    found = uncovered(source, compile_source(source), check_source(source).model, demos)
    assert [(d.code, d.severity) for d in found] == [("D804", "error"), ("D804", "error"), ("L614", "warning")]
    assert found[0].file == demos[0] and "did you mean 'altitude'" in found[0].help


def test_states_wait_for_the_environment_that_score_is_given(tmp_path):
    (tmp_path / "d.json").write_text('{"states": [[0, 0], [0, 1]]}')
    assert messages("signal d_goal\nhard a: always (d_goal > 0)\n", [tmp_path / "d.json"]) == []
