"""What is printed is plain where it is piped, and counted in English."""

import io
import json

import pytest

from stlspec.cli.output import error_document, print_diagnostics, print_json
from stlspec.errors import diagnostic

PROBLEM = diagnostic("N107", file="x.stl", name="T", help="the params of this spec: none")


def test_diagnostics_are_plain_in_a_pipe() -> None:
    stream = io.StringIO()
    print_diagnostics([PROBLEM], stream)
    assert stream.getvalue() == (
        "error[N107]: the spec has no param `T`\n  --> x.stl\n     = help: the params of this spec: none\n\n"
    )


def test_diagnostics_have_colours_in_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    stream = io.StringIO()
    monkeypatch.setattr(stream, "isatty", lambda: True)
    print_diagnostics([PROBLEM], stream)
    assert "\x1b[31m" in stream.getvalue()


def test_the_error_document_names_the_exit_code() -> None:
    document = error_document(2, [PROBLEM])
    assert (document["schema"], document["exit"]) == ("stlspec.error/1", 2)
    assert document["diagnostics"][0]["line"] is None


def test_json_is_one_document_without_nan(capsys: pytest.CaptureFixture[str]) -> None:
    print_json({"ä": 1})
    assert json.loads(capsys.readouterr().out) == {"ä": 1}
    with pytest.raises(ValueError, match="JSON"):
        print_json(float("nan"))
