"""Comments that ignore warnings: what they hide, and what they cannot."""

import pytest

from stlspec.compiler.review import review_source
from stlspec.source import SourceText

HEAD = "signal x in [0, 10]\n"


def codes(text):
    return [d.code for d in review_source(SourceText.of("s", HEAD + text)).diagnostics]


@pytest.mark.parametrize(
    "text",
    [
        "hard a: always (x < 12)  # stlspec: ignore L603\n",
        "hard a: always (x < 12)  // stlspec: ignore L603 - the sensor saturates\n",
        "hard a: always (x < 12)  #stlspec:ignore l6\n",
        "# stlspec: ignore L603\n\n# about a\nhard a: always (x < 12)\n",
        "hard a:\n    always (x < 12)  # stlspec: ignore L603\n",
        "hard a: always (x < 12) and eventually (x > 12)  # stlspec: ignore L602, L603, L608, L605, L613\n".replace(
            ", L605", ""
        ),
    ],
)
def test_a_comment_hides_the_warnings_of_its_line(text):
    assert codes(text) == []


def test_a_comment_hides_nothing_elsewhere_and_says_so():
    text = "hard a:  # stlspec: ignore L603\n    always (x < 12)\n"
    assert codes(text) == ["L618", "L603"]


def test_errors_stay_and_an_ignore_beside_them_is_not_blamed():
    assert codes("hard a: always (y < 12)  # stlspec: ignore L603\n") == ["N101"]
    assert codes("hard a: always (y < 12)  # stlspec: ignore N101\n") == ["N101", "L619"]


def test_the_fix_of_an_idle_ignore_removes_it():
    source = SourceText.of("s", HEAD + "hard a: always (x < 9)  # stlspec: ignore L603\n")
    (found,) = review_source(source).diagnostics
    assert found.code == "L618"
    assert found.fixes[0].applied(source.text) == HEAD + "hard a: always (x < 9)  \n"


def test_other_comments_are_left_alone():
    assert codes("hard a: always (x < 9)  # stlspec ignores nothing\n") == []
