"""`stlspec lsp` speaks the protocol and nothing else on stdout."""

import subprocess
import sys

MISSING = """
import sys
sys.modules["pygls"] = None
from stlspec.cli.main import run
sys.exit(run(["lsp"]))
"""
INITIALIZE = b'{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"capabilities":{}}}'


def run(words, data=b""):
    return subprocess.run([sys.executable, *words], input=data, capture_output=True, check=False)


def test_what_is_printed_by_others_is_kept_out_of_the_protocol():
    code = "import stlspec.tools.lsp.server as s, sys\nbuild = s.SpecServer.__init__\n"
    code += "def noisy(self):\n    print('noise'); build(self)\ns.SpecServer.__init__ = noisy\n"
    code += "from stlspec.cli.main import run\nsys.exit(run(['lsp', '--stdio']))"
    result = run(["-c", code], b"Content-Length: %d\r\n\r\n%b" % (len(INITIALIZE), INITIALIZE))
    assert result.returncode == 1  # the editor left without a word
    assert result.stdout.startswith(b"Content-Length: ")
    assert b"noise" not in result.stdout
    assert b"noise" in result.stderr


def test_without_the_extra_one_diagnostic_says_how_to_install_it():
    result = run(["-c", MISSING])
    assert result.returncode == 2
    assert result.stdout == b""
    assert b"D847" in result.stderr
    assert b"pip install 'stlspec[lsp]'" in result.stderr


def test_a_closed_stderr_is_no_obstacle():
    script = f"exec {sys.executable} -m stlspec lsp 2>&-"
    message = b"Content-Length: %d\r\n\r\n%b" % (len(INITIALIZE), INITIALIZE)
    result = subprocess.run(["sh", "-c", script], input=message, stdout=subprocess.PIPE, check=False)
    assert result.stdout.startswith(b"Content-Length: ")
    assert result.stdout.count(b"Content-Length: ") == 1
