"""A name is given to all that it names and to nothing else, or the reason is said why not."""

import random
import re

import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.errors import Fix, InputError, SpecError
from stlspec.source import SourceText
from stlspec.tools.lsp.documents import uri_of
from stlspec.tools.lsp.renaming import renamable, rename
from stlspec.tools.lsp.workspace import Workspace
from tests.lang.compose import Composer

SIGNALS = "signal d\nparam r = 2\nlet near(x) = x < r\n"
MAIN = """use "signals.stl"
hard a "d": always (d > 1)  # d
soft b depends on a: eventually near(d)
expect a holds on {d: [2]}
"""


def renamed(text, mark, new, **files):
    """Rename what stands at the mark in main.stl among files. Returns: the texts that change, by name."""
    space = Workspace()
    space.open("untitled:1", 1, text)
    known = space.reviewed("untitled:1")
    return {
        made.source.name: Fix("", made.edits).applied(made.source.text)
        for made in rename(space, known, at(text, mark), new)
    }


def at(text, mark):
    return re.search(mark, text).start()


@pytest.fixture
def space(tmp_path):
    (tmp_path / "signals.stl").write_text(SIGNALS)
    (tmp_path / "other.stl").write_text('use "signals.stl"\nhard c: always (d > 2)\n')
    space = Workspace()
    space.open(uri_of(str(tmp_path / "main.stl")), 1, MAIN)
    return space


def across(space, mark, new):
    known = space.reviewed(space.documents[0].uri)
    made = rename(space, known, at(MAIN, mark), new)
    return {m.source.name.rsplit("/", 1)[1]: Fix("", m.edits).applied(m.source.text) for m in made}


def test_a_signal_is_renamed_in_every_file_that_uses_it_and_in_no_text_or_comment(space):
    assert across(space, r"d > 1", "gap") == {
        "signals.stl": SIGNALS.replace("signal d", "signal gap"),
        "main.stl": MAIN.replace("(d", "(gap").replace("{d", "{gap"),
        "other.stl": 'use "signals.stl"\nhard c: always (gap > 2)\n',
    }


def test_a_requirement_is_renamed_in_its_own_file(space):
    assert across(space, r"a: eventually", "avoid") == {
        "main.stl": MAIN.replace(" a ", " avoid ").replace(" a:", " avoid:")
    }


@pytest.mark.parametrize(
    ("mark", "new", "reason"),
    [
        ("d > 1", "always", "a word of the language"),
        ("d > 1", "2d", "no name"),
        ("d > 1", "größe", "no name"),
        ("d > 1", "", "no name"),
        ("d > 1", "a b\n", "no name"),
        ("d > 1", "near", "declared at"),
        ("d > 1", "b", "declared at"),
        ("d > 1", "c", "declared at"),
        ("a: event", "d", "declared at"),
        ("always", "x", "no declared name here"),
    ],
)
def test_a_name_that_cannot_be_given_is_refused_with_the_reason(space, mark, new, reason):
    with pytest.raises(InputError, match=reason) as caught:
        across(space, mark, new)
    assert caught.value.diagnostics[0].code == "N118"


@pytest.mark.parametrize(
    ("text", "mark", "new"),
    [
        ("signal x\nlet f(r) = x < r\n", "x", "r"),
        ("signal x\nlet f(r) = x < r\n", r"r\)", "x"),
        ("signal x\nlet f(r, s) = x < r + s\n", r"s\)", "r"),
        ("signal x\nhard a: G (x > 0)\n", r"x\n", "G"),
        ("signal x\nsignal p: bool\nsignal q: bool\nhard a: p U q\n", r"x\n", "U"),
        ("signal x\nhard a: x > now\n", r"x\n", "now"),
        ("signal x\nhard a: abs(x) > 0\n", r"x\n", "abs"),
        ("signal x\nhard a: x[t] > 0\n", r"x\n", "t"),
        ("let f(x) = abs(x) > 0\nhard a: f(1)\n", r"f\(x", "abs"),
    ],
)
def test_a_name_that_would_be_read_in_another_way_is_refused(text, mark, new):
    with pytest.raises(InputError, match="stands for something else"):
        renamed(text, mark, new)


@pytest.mark.parametrize("broken", ["hard b: (x > 1\n", "hard b: (y > 1\n"])
def test_a_statement_that_cannot_be_read_and_may_mean_it_is_mended_first(broken):
    text = f"signal x\nhard a: x > 0\n{broken}"
    with pytest.raises(InputError, match=r"untitled:1:3 cannot be read"):
        renamed(text, "x", "y")
    assert renamed(text, "x", "z2") if "y" in broken else True


def test_a_statement_of_another_file_that_cannot_be_read_and_may_mean_it_is_mended_first(space, tmp_path):
    (tmp_path / "other.stl").write_text('use "signals.stl"\nhard c: always (d > \n')
    with pytest.raises(InputError, match=r"other.stl:2 cannot be read"):
        across(space, r"d > 1", "gap")


def test_the_same_name_changes_nothing():
    assert renamed("signal x\n", "x", "x") == {}


def test_what_can_be_renamed_is_the_name_under_the_cursor():
    space = Workspace()
    space.open("untitled:1", 1, "signal xy\nhard a: xy > now\n")
    known = space.reviewed("untitled:1")
    span = renamable(known, 19)
    assert known.syntax.source.slice(span) == "xy"
    assert renamable(known, 3) is None
    assert renamable(known, 24) is None


def meaning(text, old, new):
    """What a spec compiles to, with one name for the other."""
    bundle = compile_source(SourceText.of("a.stl", text))
    parts = (bundle.signals, bundle.params, bundle.nodes, dict(bundle.names), bundle.edges, bundle.weights)
    shown = repr((parts, [(r.name, r.root, r.depends_on) for r in bundle.requirements]))
    return re.sub(rf"(['\"]){old}\1", f"'{new}'", shown)


def test_renaming_any_name_of_a_random_spec_keeps_its_meaning_or_is_refused():
    rng = random.Random(11)
    done = 0
    for _ in range(25):
        text = Composer(rng).text().replace("\r\n", "\n")
        names = re.findall(r"^\s*(?:signal|param|let|hard|soft)\s+(\w+)", text, re.M)
        old, new = rng.choice(names), rng.choice(["fresh", "U", "t", "abs", rng.choice(names)])
        mark = rf"(?m)(?<=\s){old}\b(?!\")"
        try:
            after = renamed(text, mark, new).get("untitled:1", text)
        except InputError:
            continue
        try:
            assert meaning(after, new, new) == meaning(text, old, new)
        except SpecError:
            continue  # without requirements there is nothing to compile
        done += old != new
    assert done >= 5
