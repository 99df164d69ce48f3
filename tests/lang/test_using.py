"""Files that use files: found beside each other, read once, parsed with the names that they see."""

import random

import pytest

from stlspec.compiler.bundle_file import meaning_sha256
from stlspec.compiler.checks import check
from stlspec.compiler.compiling import compile_syntax
from stlspec.errors import InputError, diagnostic
from stlspec.lang.parse import parse
from stlspec.lang.using import MOST_FILES, identity, parse_with_uses, resolve
from stlspec.source import SourceText
from tests.lang.mutate import SPECS, statements


def loader(files, reads=None):
    """A loader of texts in memory; `reads` collects what was asked for."""

    def load(path):
        if reads is not None:
            reads.append(path)
        if path not in files:
            raise InputError([diagnostic("S092", file=path, verb="read", problem="no such file", help="?")])
        return SourceText.of(path, files[path])

    return load


def parsed(files, main="main.stl", reads=None):
    return parse_with_uses(SourceText.of(main, files[main]), loader(files, reads))


def found(files, main="main.stl"):
    """Code, file and line of every diagnostic."""
    _, problems = check(parsed(files, main))
    return [(d.code, d.file, d.source.position(d.span.start).line) for d in problems]


def test_what_a_file_declares_is_known_to_the_one_that_uses_it_and_through_others_too():
    files = {
        "main.stl": 'use "lib/lets.stl"\nhard a: always near',
        "lib/lets.stl": 'use "../signals.stl"\nlet near = d < r',
        "signals.stl": "signal d\nparam r = 3",
    }
    syntax = parsed(files)
    assert [file.source.name for file in syntax.used] == ["signals.stl", "lib/lets.stl"]
    assert [(s.path.text, file.source.name) for s, file in syntax.uses] == [("lib/lets.stl", "lib/lets.stl")]
    assert found(files) == []


def test_a_file_used_on_two_ways_is_read_once():
    reads = []
    files = {
        "main.stl": 'use "a.stl"\nuse "b.stl"\nuse "./a.stl"\nhard h: x > y',
        "a.stl": 'use "c.stl"\nlet y = x + 1',
        "b.stl": 'use "../here/c.stl"',
        "c.stl": "signal x",
    }
    files = {f"/here/{name}": text for name, text in files.items()}
    parsed(files, "/here/main.stl", reads)
    assert sorted(reads) == ["/here/a.stl", "/here/b.stl", "/here/c.stl"]
    assert found(files, "/here/main.stl") == []


def test_names_of_used_files_change_what_reads_as_an_operator():
    main = 'use "s.stl"\nhard a: G > 3'
    assert found({"main.stl": main, "s.stl": "signal G"}) == []
    assert found({"main.stl": 'use "s.stl"\nhard a: G (x > 3)', "s.stl": "signal x"}) == []


def test_a_file_sees_what_it_uses_and_not_what_uses_it():
    files = {"main.stl": 'use "lets.stl"\nsignal d\nhard a: near', "lets.stl": "let near = d < 1"}
    assert found(files) == [("N101", "lets.stl", 1)]


@pytest.mark.parametrize(
    ("files", "at"),
    [
        ({"main.stl": 'use "main.stl"\nhard h: x > 1'}, ("main.stl", 1)),
        ({"main.stl": 'use "b.stl"\nhard h: x > 1', "b.stl": 'signal y\nuse "main.stl"'}, ("b.stl", 2)),
        ({"main.stl": 'use "b.stl"', "b.stl": 'use "c.stl"', "c.stl": 'use "b.stl"'}, ("c.stl", 1)),
    ],
)
def test_files_that_use_each_other_are_an_error_that_names_every_place_and_no_other(files, at):
    assert found(files) == [("N110", *at)]
    _, (problem,) = check(parsed(files))
    assert len(problem.labels) + 1 == problem.message.count("->")


def test_a_name_of_two_files_is_an_error_at_both_places():
    files = {"main.stl": 'use "a.stl"\nsignal x\nhard h: x > 1', "a.stl": "param x = 2"}
    _, (problem,) = check(parsed(files))
    assert (problem.code, problem.file, problem.labels[0].source.name) == ("N102", "main.stl", "a.stl")


def test_a_missing_file_is_one_diagnostic_and_its_names_are_not_missed():
    files = {"main.stl": 'use "none.stl"\nhard h: far(x) > 1 and near', "b.stl": ""}
    assert found(files) == [("N111", "main.stl", 1)]


@pytest.mark.parametrize("path", ["", " ", "a\0b"])
def test_a_path_that_is_none_is_refused(path):
    assert found({"main.stl": f'use "{path}"\nhard h: x > 1'}) == [("N111", "main.stl", 1)]


def test_without_a_loader_a_text_can_use_no_file():
    _, (problem,) = check(parse_with_uses(SourceText.of("<text>", 'use "a.stl"\nhard h: x > 1'), None))
    assert problem.code == "N111" and "folder" in problem.message and "compile(text, folder=" in problem.help


def test_broken_statements_of_a_used_file_are_reported_there_and_not_again_where_their_names_are_used():
    files = {"main.stl": 'use "a.stl"\nhard h: near and x > 1', "a.stl": "signal x\nlet near = x <\nsignal y in [2, 1]"}
    assert found(files) == [("S002", "a.stl", 2), ("T206", "a.stl", 3)]


def test_requirements_and_expectations_of_a_used_file_stay_its_own():
    base = 'signal d\nlet far = d > 1\nhard safe: always far\nexpect safe holds on "no_such.csv"'
    main = 'use "base.stl"\nsoft quick depends on {}: eventually {}'
    assert found({"main.stl": main.format("quick", "far").replace("depends on quick", ""), "base.stl": base}) == []
    assert found({"main.stl": main.format("safe", "safe"), "base.stl": base}) == [("N112", "main.stl", 2)] * 2
    own = 'use "base.stl"\nhard safe: far'
    assert found({"main.stl": own, "base.stl": base}) == []


@pytest.mark.parametrize(
    ("mine", "theirs", "agree"),
    [
        ("time s", "time s", True),
        ("time s", "", True),
        ("", "", True),
        ("time 100 ms", "time 0.1 s", False),
        ("time s", "time ms", False),
        ("", "time s", False),
        ("", "time step", True),
        ("time s", "time step", False),
    ],
)
def test_files_measure_time_in_the_same_way(mine, theirs, agree):
    files = {
        "main.stl": f'{mine}\nuse "a.stl"\nhard h: soon',
        "a.stl": f"{theirs}\nsignal x\nlet soon = eventually (x > 1)",
    }
    assert [code for code, *_ in found(files)] == ([] if agree else ["U307"])


def test_the_number_of_files_is_bounded():
    files = {f"f{i}.stl": f'use "f{i + 1}.stl"\nsignal x{i}' for i in range(MOST_FILES + 20)}
    files["main.stl"] = 'use "f0.stl"\nhard h: x0 > 1'
    assert [code for code, *_ in found(files)] == ["N111"]
    files = {f"f{i}.stl": f"signal x{i}" for i in range(MOST_FILES + 20)}
    files["main.stl"] = "\n".join(f'use "{name}"' for name in files) + "\nhard h: x0 > 1"
    assert [code for code, *_ in found(files)] == ["N111"] * 20


def test_paths_are_those_that_can_be_opened(tmp_path):
    assert resolve("spec.stl", "a.stl") == "a.stl"
    assert resolve("specs/spec.stl", "../a.stl") == "a.stl"
    assert resolve("specs/spec.stl", "/b/a.stl") == "/b/a.stl"
    (tmp_path / "real" / "deep").mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "real" / "deep")
    (tmp_path / "real" / "a.stl").write_text("signal x")
    found = resolve(str(tmp_path / "spec.stl"), "link/../a.stl")
    assert identity(found) == str(tmp_path / "real" / "a.stl")


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.split()[1])
def test_how_a_spec_is_split_into_files_does_not_change_its_meaning(spec):
    rng = random.Random(7)
    whole = meaning_sha256(compile_syntax(parse_with_uses(SourceText.of("main.stl", spec), None)))
    for moves_lets in (True, False) * 3:
        files = {"main.stl": "", "a.stl": "", "b.stl": 'use "a.stl"\n'}
        for text in statements(spec):
            name = "main.stl"
            if text.startswith(("signal", "param")):
                name = rng.choice(["main.stl", "a.stl", "b.stl"] if not moves_lets else ["a.stl", "b.stl"])
            elif text.startswith("let") and moves_lets:
                name = "b.stl"
            files[name] += text + "\n"
        files["main.stl"] += 'use "b.stl"\n'
        assert meaning_sha256(compile_syntax(parsed(files))) == whole


def test_a_parser_that_remembers_can_be_handed_in():
    asked = []

    def remembering(source, names):
        asked.append((source.name, sorted(names)))
        return parse(source, names)

    files = {"main.stl": 'use "a.stl"\nhard h: G > 1', "a.stl": "signal G"}
    parse_with_uses(SourceText.of("main.stl", files["main.stl"]), loader(files), remembering)
    assert asked == [("main.stl", []), ("a.stl", []), ("main.stl", ["G"])]
