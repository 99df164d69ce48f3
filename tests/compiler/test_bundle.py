"""The compiled spec as data."""

from dataclasses import FrozenInstanceError

import pytest

from stlspec.compiler.compiling import compile_source
from stlspec.source import SourceText

TEXT = "signal x\nhard a: always[0, 3] x > 1\nsoft b depends on a: x > 2\nsoft c depends on b, a: x > 3"


def test_edges_run_from_prerequisite_to_dependant_as_declared():
    assert compile_source(SourceText.of("s", TEXT)).edges == (("a", "b"), ("b", "c"), ("a", "c"))


def test_the_horizon_is_none_as_soon_as_one_requirement_has_no_end():
    assert compile_source(SourceText.of("s", TEXT)).horizon == 3
    assert compile_source(SourceText.of("s", TEXT + "\nhard d: always x > 1")).horizon is None


def test_a_bundle_cannot_be_changed():
    bundle = compile_source(SourceText.of("s", TEXT))
    with pytest.raises(FrozenInstanceError):
        bundle.name = "other"
    with pytest.raises(TypeError):
        bundle.names["p"] = 0


def test_equal_texts_give_equal_bundles():
    assert compile_source(SourceText.of("s", TEXT)) == compile_source(SourceText.of("s", TEXT))
