"""One formula without a spec means what it means inside one."""

import pytest

from stlspec.demos import load_demonstrations
from stlspec.errors import InputError, SpecError, UsageError
from stlspec.formulas import compile_formula, evaluate_on


def test_names_become_signals_and_params_numbers() -> None:
    bundle = compile_formula("G (x > c and armed)", frozenset({"armed"}), "step", {"c": "2"})
    assert [(s.name, s.type) for s in bundle.signals] == [("x", "real"), ("armed", "bool")]
    assert bundle.evaluate({"x": [3, 4], "armed": [1, 1]})["formula"].robustness == 1.0


def test_a_column_called_like_an_operator_is_an_operator_unless_it_is_boolean(tmp_path) -> None:
    file = tmp_path / "x.csv"
    file.write_text("G,x\ntrue,1\ntrue,2\n")
    (row,) = evaluate_on("G and x > 0", load_demonstrations([file]))
    assert row.result.robustness == 1.0


def test_time_is_read_as_in_a_spec() -> None:
    bundle = compile_formula("F[0, 1 s] x > 0", frozenset(), "250 ms")
    assert bundle.horizon == 1_000_000_000
    for wrong in ("( soon", "abc", "125 m", "0 s", "s\nsignal x"):
        with pytest.raises(UsageError, match="--time"):
            compile_formula("x > 0", frozenset(), wrong)


def test_a_param_may_be_a_bound_with_a_time_unit() -> None:
    assert compile_formula("F[0, T] x > 0", frozenset(), "s", {"T": "12s"}).horizon == 12 * 10**9


@pytest.mark.parametrize("text", ["", "always x", "always (x > 0", "x > > 1", "x = 1"])
def test_a_wrong_formula_is_a_spec_error(text: str) -> None:
    with pytest.raises(SpecError):
        compile_formula(text, frozenset())


@pytest.mark.parametrize(("name", "value"), [("c", "soon"), ("c", "nan"), ("c", "1e999")])
def test_a_param_that_is_no_number_is_refused(name: str, value: str) -> None:
    with pytest.raises(InputError, match="N108"):
        compile_formula("x > c", frozenset(), "step", {name: value})


@pytest.mark.parametrize(
    ("formula", "time", "said"),
    [
        ("always[0, 3 s] (x < 3)", "step", "give `--time 's'`"),
        ("x < 3 m", "step", "leave the unit out"),
        ("rate(x) < 3 m/s", "s", "leave the unit out"),
        ("always (X < 3)", "s", "did you mean 'x'? write `x`"),
        ("always (dist < 3)", "s", "a formula cannot name it"),
        ("always[0, T] (x < 3)", "step", "-p NAME=VALUE"),
        ("always (x < 3)", "100 ms", "give `--time '0.1 s'`"),
        ("alway[0, 3] (x < 3)", "step", "write `always`"),
    ],
)
def test_ways_out_are_those_of_the_command_line(tmp_path, formula, time, said) -> None:
    (tmp_path / "d.csv").write_text("time,x,dist [m]\n0,1,1\n0.1,2,2\n")
    with pytest.raises((SpecError, InputError)) as error:
        evaluate_on(formula, load_demonstrations([tmp_path / "d.csv"]), time)
    (found,) = error.value.diagnostics
    assert said in found.help and "declar" not in found.help
