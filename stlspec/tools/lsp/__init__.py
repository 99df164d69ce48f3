"""The language server: what editors show of a spec as one types."""
