"""Environments, and the signals they offer; only this package and those after it import gymnasium."""
