"""Codes of this stage."""

from stlspec.errors.model import Code

CODES: tuple[Code, ...] = ()
