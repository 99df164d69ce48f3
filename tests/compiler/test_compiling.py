"""The front end in one call; params from outside."""

import numpy as np
import pytest

from stlspec.compiler.compiling import check_source, compile_source
from stlspec.errors import InputError, SpecError
from stlspec.source import SourceText

TEXT = "time s\nsignal x\nparam T = 8 s\nparam level = 1\nparam open\nhard a: always[0, T] x > level + open\n"


def compiled(params, text=TEXT):
    bundle = compile_source(SourceText.of("s", text), params)
    return {p.name: (p.value, p.unit) for p in bundle.params}


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (12, 12),
        (12.5, 12.5),
        ("12", 12),
        ("12s", 12),
        (" 12 s ", 12),
        ("500ms", 0.5),
        ("2 min", 120),
        ("1e1", 10),
        (np.int64(12), 12),
        (np.float32(0.5), 0.5),
        ("+3", 3),
        ("inf", float("inf")),
    ],
)
def test_a_value_is_in_the_declared_unit_or_converted_to_it(given, expected):
    assert compiled({"T": given, "open": 0})["T"] == (expected, "s")


@pytest.mark.parametrize(
    "given", ["soon", "", "12 m", "nan", float("nan"), True, None, [1], "1e999", 10**400, "12 s s", "0x10", "١٢"]
)
def test_what_is_no_value_is_an_input_error(given):
    with pytest.raises(InputError) as caught:
        compiled({"T": given, "open": 0})
    assert [d.code for d in caught.value.diagnostics] == ["N108"]


def test_a_param_without_value_and_unit_takes_the_unit_that_is_given():
    text = "time s\nsignal x\nparam T\nhard a: always[0, T] x > 1"
    assert compiled({"T": "200 ms"}, text) == {"T": (200, "ms")}
    assert compile_source(SourceText.of("s", text), {"T": "200ms"}).horizon == 200_000_000
    with pytest.raises(SpecError) as caught:
        compiled({"T": 200}, text)
    assert [d.code for d in caught.value.diagnostics] == ["U303"]


def test_a_value_for_no_param_is_told_the_nearest():
    with pytest.raises(InputError) as caught:
        compiled({"opne": 3, "zzz": 4})
    assert [d.code for d in caught.value.diagnostics] == ["N107", "N107"]
    assert caught.value.diagnostics[0].help == "did you mean `open`?"
    assert "`T`, `level`, `open`" in caught.value.diagnostics[1].help


def test_an_unbound_param_is_accepted_by_check_and_refused_by_compile_with_its_place():
    assert check_source(SourceText.of("s", TEXT)).diagnostics == ()
    with pytest.raises(InputError) as caught:
        compiled({})
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.source.slice(problem.span), caught.value.exit_code) == ("N106", "open", 2)


def test_a_value_that_makes_the_spec_wrong_is_a_spec_error():
    with pytest.raises(SpecError) as caught:
        compiled({"T": -1, "open": 0})
    assert [d.code for d in caught.value.diagnostics] == ["I402"]


def test_a_spec_without_requirements_checks_but_does_not_compile():
    assert check_source(SourceText.of("s", "signal x")).diagnostics == ()
    with pytest.raises(SpecError) as caught:
        compile_source(SourceText.of("s", "signal x"))
    assert [d.code for d in caught.value.diagnostics] == ["G506"]


def test_warnings_do_not_keep_a_spec_from_being_compiled():
    source = SourceText.of("s", "signal x\nhard a: x > 1\nsoft b: always[0, 2.5] x > 1")
    result = check_source(source)
    assert ([d.code for d in result.diagnostics], result.errors) == (["G505", "I403"], ())
    assert compile_source(source).horizon == 2


def test_an_empty_text_is_a_spec_with_an_error():
    with pytest.raises(SpecError) as caught:
        compile_source(SourceText.of("s", " \n# nothing\n"))
    assert ([d.code for d in caught.value.diagnostics], caught.value.exit_code) == (["S016"], 1)


def test_a_given_time_in_another_unit_is_rounded_once():
    text = "time s\nparam T = 8 s\nparam U = 8 ms\nhard a: now <= T or now <= U"
    for n in range(1, 2000):
        assert compiled({"T": f"{n} ms", "U": f"{n / 1000!r} s"}, text) == {"T": (n / 1000, "s"), "U": (n, "ms")}


def test_the_way_out_of_a_bad_value_is_a_number_without_a_unit():
    with pytest.raises(InputError) as caught:
        compiled({"level": "3 s", "open": 0})
    assert "-p level=12;" in caught.value.diagnostics[0].help
