"""Specs of RTAMT are found in programs, which are never run."""

import pytest

from stlspec.errors import SpecError
from stlspec.source import SourceText
from stlspec.tools.importing.conversion import convert
from stlspec.tools.importing.python import embedded, looks_like_program

PROGRAM = """import sys, rtamt  # Größe: places count characters, not bytes

def monitor():
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.declare_var('req', 'float')
    spec.declare_const('T', 'float', '3')
    spec.unit = 'ms'
    spec.set_sampling_period(500, 'ms', 0.1)
    spec.spec = ('out = always((req >= T) implies '  # é
                 "(eventually[500:1500](gnt >= 3)))")
    spec.parse()
    raise SystemExit("this was run")
"""


def program(text):
    return SourceText.of("monitor.py", text)


def test_a_program_is_told_by_its_name_or_by_what_it_imports():
    assert looks_like_program(program(""))
    assert looks_like_program(SourceText.of("x.txt", "import rtamt\n"))
    assert not looks_like_program(SourceText.of("x.txt", "out = always(x > 1)"))


def test_the_spec_stays_where_it_stands_and_all_else_is_blank():
    found = embedded(program(PROGRAM))
    assert len(found.source.text) == len(PROGRAM)
    words = found.source.text.split()
    assert " ".join(words) == "out = always((req >= T) implies (eventually[500:1500](gnt >= 3)))"
    assert found.source.text.index("gnt") == PROGRAM.index("gnt")
    assert [(name, value) for name, _, value in found.constants] == [("T", 3.0)]
    assert (found.period, found.unit) == ("500 ms", "ms")


def test_period_unit_and_constants_of_the_program_are_carried():
    assert convert(program(PROGRAM)).text == (
        "time 500 ms\n\nsignal req\nsignal gnt\n\nparam T = 3\n\nhard out:\n"
        "    always ((req >= T) implies eventually[500 ms, 1500 ms] (gnt >= 3))\n"
    )
    seconds = PROGRAM.replace("    spec.unit = 'ms'\n", "").replace("500:1500", "0.5:1.5")
    assert "eventually[0.5 s, 1.5 s]" in convert(program(seconds)).text


def test_parts_that_are_added_come_first():
    text = "import rtamt\ns.add_sub_spec('near = x < 1')\ns.spec = 'out = always near'\n"
    assert "let near = x < 1" in convert(program(text)).text


def test_diagnostics_point_into_the_program():
    broken = PROGRAM.replace("gnt >= 3", "norm(gnt) >= 3")
    with pytest.raises(SpecError) as caught:
        convert(program(broken))
    (problem,) = caught.value.diagnostics
    assert problem.source.text == broken and problem.source.slice(problem.span) == "norm"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("import rtamt\n", "S043"),
        ("import rtamt\ns.spec = 'x > 1'\nr.spec = 'y > 1'\n", "S043"),
        ("import rtamt\ns.spec = f'x > {limit}'\n", "S040"),
        ("import rtamt\ns.spec = text\n", "S040"),
        ("import rtamt\ns.declare_const('T', 'float', 'soon')\ns.spec = 'x > T'\n", "S040"),
        ("def (:", "S043"),
        ("\0", "S043"),
        ("import rtamt\ns.spec = ''\n", "S043"),
    ],
)
def test_what_is_no_one_fixed_spec_is_refused(text, code):
    with pytest.raises(SpecError) as caught:
        convert(program(text))
    assert [p.code for p in caught.value.diagnostics] == [code]
