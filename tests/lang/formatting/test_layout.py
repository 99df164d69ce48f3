"""Lines break where they are too long, and comments keep their order whatever the text around them does."""

from stlspec.lang.formatting.layout import HARD, LINE, SOFT, WIDTH, Comment, Fold, Indent, Leaf, Lines


def written(doc, *comments):
    lines = Lines(comments)
    lines.begin(blank_above=False)
    lines.write(doc)
    lines.comments_before(10**6, 4)
    return lines.text()


def call(length):
    return Fold(("f(", Indent((SOFT, Leaf("a" * length, 2), ",", LINE, Leaf("b", 4))), SOFT, Leaf(")", 5)), 0, 6)


def test_what_fits_stays_on_one_line_to_the_last_column():
    assert written(call(WIDTH - 6)) == f"f({'a' * (WIDTH - 6)}, b)\n"
    assert written(call(WIDTH - 5)) == f"f(\n    {'a' * (WIDTH - 5)},\n    b\n)\n"


def test_what_follows_up_to_the_next_break_must_fit_too():
    assert written((call(WIDTH - 8), "xy")) == f"f({'a' * (WIDTH - 8)}, b)xy\n"
    assert written((call(WIDTH - 8), "xyz")).startswith("f(\n")
    assert written((call(WIDTH - 8), HARD, "xyz")) == f"f({'a' * (WIDTH - 8)}, b)\nxyz\n"


def test_a_comment_inside_breaks_a_group_and_ends_its_line():
    trailing = Comment("# c", 3, trailing=True, blank_above=False)
    assert written(call(1), trailing) == "f(\n    a,  # c\n    b\n)\n"


def test_a_comment_on_a_line_of_its_own_stays_there_with_one_blank_line_above():
    own = Comment("# c", 3, trailing=False, blank_above=True)
    assert written(call(1), own) == "f(\n    a,\n\n    # c\n    b\n)\n"


def test_two_comments_never_share_a_line():
    both = [Comment(f"# {at}", at, trailing=True, blank_above=False) for at in (10, 20)]
    assert written("a", *both) == "a  # 10\n    # 20\n"


def test_text_without_a_break_still_begins_a_line_behind_a_comment():
    comment = Comment("# c", 1, trailing=True, blank_above=False)
    assert written((Leaf("-", 0), Leaf("x", 5)), comment) == "-  # c\nx\n"
