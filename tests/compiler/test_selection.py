"""Which warnings are reported: settings of a project, of the command line, and what they cannot do."""

import pytest

from stlspec.compiler.selection import Selection, configured, override
from stlspec.errors import InputError, diagnostic

WARNING = diagnostic("L615", name="x")
ERROR = diagnostic("G503", name="x")


@pytest.mark.parametrize(
    ("selection", "level"),
    [
        (Selection(), "warning"),
        (Selection(ignore=("L6",)), "off"),
        (Selection(ignore=("L",), select=("L615",)), "warning"),
        (Selection(ignore=("L615",), select=("L6",)), "off"),
        (Selection(select=("G",)), "off"),
        (Selection(ignore=("ALL",)), "off"),
        (Selection(deny=True), "error"),
        (Selection(levels={"L6": "error"}), "error"),
        (Selection(levels={"L6": "error", "L615": "off"}), "off"),
    ],
)
def test_the_longest_name_that_fits_decides(selection, level):
    assert selection.level(WARNING) == level
    assert [d.severity for d in selection.applied([WARNING])] == ([] if level == "off" else [level])


def test_errors_are_reported_whatever_is_selected():
    for selection in (Selection(ignore=("ALL",)), Selection(select=("L",)), Selection(levels={"G": "off"})):
        assert selection.applied([ERROR]) == (ERROR,)


def test_the_nearest_settings_hold_and_the_command_line_goes_before_them(tmp_path):
    inner = tmp_path / "a" / "b"
    inner.mkdir(parents=True)
    (tmp_path / "pyproject.toml").write_text(
        '[tool.stlspec]\nignore = ["l615"]\ndeny = "warning"\nlevels = {G5 = "off"}\n'
    )
    (tmp_path / "a" / "pyproject.toml").write_text("[project]\nname = 'a'\n")
    found = configured(inner / "x.stl")
    assert found == Selection(ignore=("L615",), deny=True, levels={"G5": "off"})
    for given in ([""], [" , "]):
        with pytest.raises(InputError) as refused:
            override(found, given, None, None)
        assert "no code is given" in refused.value.diagnostics[0].message
    assert override(found, None, ["G505, L60", "L61"], None).ignore == ("G505", "L60", "L61")
    assert override(found, ["L6"], None, None).ignore == ("L615",)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[tool.stlspec]\nignroe = []\n", "no setting `ignroe`"),
        ('[tool.stlspec]\nignore = "L603"\n', "no list of codes"),
        ('[tool.stlspec]\nignore = ["L999"]\n', "no code `L999`"),
        ('[tool.stlspec]\nignore = ["N101"]\n', "errors cannot be ignored"),
        ('[tool.stlspec]\nlevels = {N101 = "warning"}\n', "errors cannot be ignored"),
        ('[tool.stlspec]\nlevels = {L603 = "loud"}\n', "is no level"),
        ('[tool.stlspec]\nlevels = {L603 = ["off"]}\n', "is no level"),
        ("[tool.stlspec]\nlevels = 3\n", "no table"),
        ("[tool.stlspec]\ndeny = 3\n", "`deny`"),
        ("[tool]\nstlspec = 3\n", "no table"),
        ("[tool.stlspec\n", "line 1"),
        ("x = " + "[" * 5000, ""),
    ],
)
def test_settings_that_cannot_be_used_are_one_diagnostic(tmp_path, text, said):
    (tmp_path / "pyproject.toml").write_text(text)
    with pytest.raises(InputError) as caught:
        configured(tmp_path / "x.stl")
    (found,) = caught.value.diagnostics
    assert found.code == "S094" and said in found.message and found.file.endswith("pyproject.toml")


@pytest.mark.parametrize(
    "options", [(["Z9"], None, None), (None, ["S001"], None), (None, None, ["error"]), (["L6"], ["L999"], None)]
)
def test_options_that_cannot_be_used_are_refused(options):
    with pytest.raises(InputError) as caught:
        override(Selection(), *options)
    assert [d.code for d in caught.value.diagnostics] == ["D880"]
