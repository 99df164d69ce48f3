"""SARIF 2.1.0: levels, rules and regions, in code points, and fixes as replacements."""

from stlspec.compiler.review import review_source
from stlspec.errors import diagnostic
from stlspec.source import SourceText
from stlspec.tools.sarif import sarif_log, uri

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


def test_absolute_paths_are_file_uris():
    assert uri("/a b/c.stl") == "file:///a%20b/c.stl"
