"""The command line: arguments in, calls of the public functions, results out, an exit code.

Exit codes: 0 fine; 1 the spec has errors or a gate fails; 2 usage, or an input that cannot be used; 3 a fault of
stlspec; 130 Ctrl-C. Results go to stdout, everything else to stderr; with `--format json` stdout is one document.
"""
