"""Whole pages: the report on scores; and the style that every page of stlspec has."""
