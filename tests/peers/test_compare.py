"""The comparison counts honestly: what differs, what says nothing, what dies, what is not installed."""

import json
from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from tests.peers import compare
from tests.peers.environments import NotInstalledError
from tests.peers.fragments import Case

CASE = Case(["pred", "x", ">", 1.0], {"x": [1.0, 3.0]}, [0, 1])


@dataclass
class FakeTool:
    """An environment that answers from a list; a None in it ends the process."""

    answers: list
    tool: str = "rtamt"
    runs: int = 0

    def run(self, script, text, timeout):
        self.runs += 1
        lines = [json.dumps({"version": "1"})]
        for _ in text.splitlines():
            answer = self.answers.pop(0)
            if answer is None:
                return SimpleNamespace(stdout="\n".join(lines), stderr="", returncode=-6)
            lines.append(json.dumps(answer))
        return SimpleNamespace(stdout="\n".join(lines), stderr="", returncode=0)


def judged(answer):
    tally = compare.Tally("1")
    compare.judge(CASE, answer, tally)
    return tally


def test_equal_values_agree_and_count_their_samples():
    tally = judged({"values": [[0.0, 0.0], [1.0, 2.0]]})
    assert (tally.agree, tally.samples, tally.silent, tally.differing) == (1, 2, 0, [])


def test_no_value_is_neither_agreement_nor_disagreement():
    tally = judged({"values": []})
    assert (tally.agree, tally.silent, tally.differing) == (0, 1, [])


def test_a_difference_is_put_to_the_definition():
    ((case, what),) = judged({"values": [[0.0, 0.0], [1.0, 5.0]]}).differing
    assert case is CASE
    assert what == "at 1: 5.0 there, 2.0 here, 2.0 by definition: stlspec agrees with the definition"


def test_a_difference_of_ours_is_named_as_such(monkeypatch):
    monkeypatch.setattr(compare, "own_values", lambda case: [0.0, 7.0])
    ((_, what),) = judged({"values": [[1.0, 2.0]]}).differing
    assert what.endswith("stlspec differs from the definition")


def test_an_error_of_the_tool_is_a_disagreement():
    assert len(judged({"error": "boom"}).differing) == 1


def test_a_case_that_kills_the_process_does_not_hide_the_others():
    good = {"values": [[0.0, 0.0]]}
    tool = FakeTool([good, None, good])
    tally = compare.compare("rtamt", [CASE] * 3, tool)
    assert (tally.agree, len(tally.differing), tool.runs) == (2, 1, 2)


def test_a_driver_that_does_not_start_is_not_taken_for_agreement():
    silent = SimpleNamespace(tool="rtamt", run=lambda *_: SimpleNamespace(stdout="", stderr="no module", returncode=1))
    with pytest.raises(NotInstalledError, match="no module"):
        compare.compare("rtamt", [CASE], silent)


def test_a_tool_that_does_not_install_is_reported(monkeypatch, capsys, tmp_path):
    def refuse(tool, work):
        raise NotInstalledError("no compiler")

    monkeypatch.setattr(compare, "environment", refuse)
    assert compare.main(["--cases", "1", "--work", str(tmp_path)]) == 0
    assert capsys.readouterr().out.count("SKIPPED, no compiler") == 4


@pytest.mark.parametrize(("answer", "exit_code"), [({"values": [[0.0, 1e9]]}, 1), ({"values": []}, 0)])
def test_only_a_disagreement_sets_the_exit_code(monkeypatch, capsys, tmp_path, answer, exit_code):
    monkeypatch.setattr(compare, "environment", lambda tool, work: FakeTool([answer] * 9))
    arguments = ["--cases", "1", "--tools", "rtamt", "--work", str(tmp_path)]
    assert compare.main(arguments) == exit_code
    assert "NOT SEEN" in capsys.readouterr().out or exit_code
