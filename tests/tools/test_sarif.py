"""SARIF 2.1.0: levels, rules and regions, in code points, and fixes as replacements; valid by the official schema."""

import hashlib
import json
import os
import re
from pathlib import Path

import jsonschema
import pytest

from stlspec.cli.main import run
from stlspec.compiler.review import review_source
from stlspec.errors import CATALOGUE, diagnostic
from stlspec.source import SourceText
from stlspec.tools.sarif import sarif_log, uri

FOLDER = Path(__file__).parent / "sarif"
SCHEMA = FOLDER / "sarif-schema-2.1.0.json"
VALIDATOR = jsonschema.Draft4Validator(json.loads(SCHEMA.read_text(encoding="utf-8")))
CORPUS = sorted((Path(__file__).parents[1] / "corpus").glob("*.stl"))
URI = re.compile(r"(?:file:///)?(?:[A-Za-z0-9._~/-]|%[0-9A-F]{2})+\Z")
"""A URI reference by RFC 3986 of the kind that is written for files: no colon in a relative one's first segment."""

TEXT = (
    'signal x in [0, 10] "höhe 𝛑"\nsignal p: bool\nsignal q: bool\nsignal spare\n'
    "hard a: always (x < 12)\nhard b: always[0, 5] p\nhard c: always p\n"
    "soft d depends on a: always (p implies next q)\n"
)


def results_of(text):
    log = sarif_log(review_source(SourceText.of("specs/a b.stl", text)).diagnostics)
    return log["runs"][0]["results"], log["runs"][0]["tool"]["driver"]["rules"]


def test_every_result_has_a_level_a_message_and_a_rule_with_help():
    results, rules = results_of(TEXT)
    assert [r["ruleId"] for r in results] == ["L615", "L603", "L606", "L610"]
    for result in results:
        assert result["level"] == "warning" and result["message"]["text"]
        rule = rules[result["ruleIndex"]]
        assert rule["id"] == result["ruleId"] and "Bad:" in rule["help"]["text"]


def test_regions_count_code_points_from_1_and_fixes_are_replacements():
    results, _ = results_of(TEXT)
    last = results[-1]
    region = last["locations"][0]["physicalLocation"]["region"]
    assert region == {"startLine": 8, "startColumn": 40, "endLine": 8, "endColumn": 44}
    (change,) = last["fixes"][0]["artifactChanges"]
    assert change["replacements"] == [{"deletedRegion": region, "insertedContent": {"text": "wnext"}}]
    assert last["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "specs/a%20b.stl"


def test_second_places_are_related_locations():
    results, _ = results_of(TEXT)
    (related,) = results[2]["relatedLocations"]
    assert related["message"]["text"] == "`c` is stated here"


def test_a_diagnostic_without_a_place_is_a_result_too():
    (result,) = sarif_log([diagnostic("S092", file="a.stl", verb="read", problem="no", help="?")])["runs"][0]["results"]
    assert result["level"] == "error" and "region" not in result["locations"][0]["physicalLocation"]


def test_absolute_paths_are_file_uris_and_paths_that_are_no_text_keep_their_bytes():
    assert uri("/a b/c.stl") == "file:///a%20b/c.stl"
    assert uri(os.fsdecode(b"\xff.stl")) == "%FF.stl"
    assert_valid(sarif_log([diagnostic("S092", file=os.fsdecode(b"/\xff"), verb="read", problem="no", help="?")]))


def assert_valid(log):
    """Hold a log to the schema, and to what the schema leaves to the text of the standard."""
    errors = [f"{e.json_path}: {e.message}" for e in VALIDATOR.iter_errors(log)]
    assert errors == []
    (run,) = log["runs"]
    ids = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
    assert len(set(ids)) == len(ids)
    for result in run["results"]:
        assert result["level"] in ("error", "warning", "note")
        assert ids[result["ruleIndex"]] == result["ruleId"]
        places = [x["physicalLocation"] for x in result.get("locations", []) + result.get("relatedLocations", [])]
        changes = [change for fix in result.get("fixes", []) for change in fix["artifactChanges"]]
        regions = [place["region"] for place in places if "region" in place]
        for place in [*places, *changes]:
            assert URI.match(place["artifactLocation"]["uri"])
        for region in regions + [r["deletedRegion"] for change in changes for r in change["replacements"]]:
            start, end = (region["startLine"], region["startColumn"]), (region["endLine"], region["endColumn"])
            assert (1, 1) <= start <= end


def test_the_schema_is_the_one_that_its_notice_speaks_of():
    digest = hashlib.sha256(SCHEMA.read_bytes()).hexdigest()
    assert digest in (FOLDER / "README.md").read_text(encoding="utf-8")
    jsonschema.Draft4Validator.check_schema(VALIDATOR.schema)


@pytest.mark.parametrize("path", CORPUS, ids=lambda p: p.stem)
def test_rejected_specs_give_valid_logs(path):
    found = review_source(SourceText.of(str(path), path.read_text(encoding="utf-8"))).diagnostics
    log = sarif_log(found)
    assert_valid(log)
    assert len(log["runs"][0]["results"]) == len(found) > 0


def test_the_examples_of_the_catalogue_give_a_valid_log_of_both_levels_with_labels_and_fixes():
    found = [d for row in CATALOGUE.values() for d in review_source(SourceText.of("a.stl", row.bad)).diagnostics]
    log = sarif_log(found)
    assert_valid(log)
    results = log["runs"][0]["results"]
    assert {r["level"] for r in results} == {"error", "warning"}
    assert sum("fixes" in r for r in results) > 10 and sum("relatedLocations" in r for r in results) > 5


def test_the_schema_refuses_what_is_not_sarif():
    log = sarif_log(review_source(SourceText.of("a.stl", TEXT)).diagnostics)
    log["runs"][0]["results"][0]["level"] = "fatal"
    with pytest.raises(AssertionError, match="fatal"):
        assert_valid(log)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("a b.stl", "a%20b.stl"),
        ("höhe/𝛑.stl", "h%C3%B6he/%F0%9D%9B%91.stl"),
        ("a:b#c?d%e.stl", "a%3Ab%23c%3Fd%25e.stl"),
    ],
)
@pytest.mark.parametrize("text", ["signal d\nhard a: always (d > \n", None])
def test_the_command_writes_valid_logs_for_any_path(tmp_path, monkeypatch, capsys, name, expected, text):
    monkeypatch.chdir(tmp_path)
    path = Path(name)
    if text is not None:
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    assert run(["check", "--format", "sarif", name, str(path.absolute())]) == (1 if text else 2)
    log = json.loads(capsys.readouterr().out)
    assert_valid(log)
    places = [r["locations"][0]["physicalLocation"] for r in log["runs"][0]["results"]]
    assert [p["artifactLocation"]["uri"] for p in places] == [
        expected,
        f"{tmp_path.as_uri()}/{expected}",
    ]
    assert all(("region" in place) == (text is not None) for place in places)
