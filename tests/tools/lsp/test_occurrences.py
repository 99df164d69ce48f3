"""Two places have one target exactly if they name the same thing."""

from stlspec.lang.parse import parse
from stlspec.lang.using import parse_with_uses
from stlspec.source import SourceText
from stlspec.tools.lsp.occurrences import Scope, at

TEXT = """signal x in [0, T]
param T = 5
let near(x, r) = x < r and T > 1
let calm = rate(x) < 1
hard a: always[0, T] (near(x, 2) and calm and x[t] > now)
soft b depends on a: eventually (x > 0)
expect a holds on {x: [1, 2], time: [0, 1]}
"""


def scope(text, name="main.stl", **others):
    files = {f"{key}.stl": value for key, value in others.items()}
    return Scope.of(parse_with_uses(SourceText.of(name, text), lambda path: SourceText.of(path, files[path])))


def places(scope, kind, name):
    """Return line:column of each occurrence of the first target of that kind and name."""
    found = scope.occurrences()
    (target,) = {o.target for o in found if (o.target.kind, o.target.name) == (kind, name)}
    source = scope.syntax.source
    spots = [source.position(o.span.start) for o in found if o.target == target]
    return [f"{p.line}:{p.column}" for p in spots]


def test_uses_are_found_in_ranges_intervals_calls_indices_dependencies_and_expectations():
    here = scope(TEXT)
    assert places(here, "param", "T") == ["1:17", "2:7", "3:28", "5:19"]
    assert places(here, "let", "near") == ["3:5", "5:23"]
    assert places(here, "requirement", "a") == ["5:6", "6:19", "7:8"]


def test_an_argument_hides_a_signal_in_its_template_only():
    here = scope(TEXT)
    assert places(here, "argument", "x") == ["3:10", "3:18"]
    assert places(here, "signal", "x") == ["1:8", "4:17", "5:28", "5:47", "6:34", "7:20"]


def test_a_template_may_have_the_name_of_one_of_its_arguments():
    here = scope("let f(f) = f > 0\n")
    assert places(here, "let", "f") == ["1:5"]
    assert places(here, "argument", "f") == ["1:7", "1:12"]


def test_what_nothing_declares_has_no_occurrence():
    names = {o.target.name for o in scope(TEXT).occurrences()}
    assert names == {"x", "T", "near", "calm", "a", "b", "r"}
    assert scope("hard a: always (y > abs(now))\n").occurrences()[0].target.name == "a"


def test_a_used_file_and_its_user_name_the_same_thing_by_one_target():
    main = scope('use "s.stl"\nhard a: always (d > 1)\n', s="signal d\nhard a: always (d > 2)\n")
    (used,) = main.syntax.used
    of_used = {(o.target.name, o.target.kind): o.target for o in Scope.of(used).occurrences()}
    of_main = {(o.target.name, o.target.kind): o.target for o in main.occurrences()}
    assert of_main["d", "signal"] == of_used["d", "signal"]
    assert of_main["a", "requirement"] != of_used["a", "requirement"]


def test_the_occurrence_at_an_offset_holds_it_or_ends_there():
    here = Scope.of(parse(SourceText.of("a.stl", "signal ab\n")))
    found = here.occurrences()
    assert [at(found, k) is not None for k in range(10)] == [False] * 7 + [True] * 3
