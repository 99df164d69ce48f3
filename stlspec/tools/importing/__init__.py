"""Specs of other tools as text of this language: one module a dialect, one for their tokens, one for the writing."""
