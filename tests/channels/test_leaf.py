"""Claim: channels are a leaf that costs a run and a command little, and all words have a file."""

import subprocess
import sys

from crashsolve.channels import statistic
from crashsolve.channels.folder import module_of, words_in

NEEDED = (
    *("abs", "resultant", "norm", "integral", "derivative", "envelope"),
    *("cfc", "si", "hic", "hic_start", "hic_end", "clip"),
)


def test_every_function_and_statistic_has_a_description() -> None:
    assert set(NEEDED) <= set(words_in("functions"))
    for folder, entry in (("functions", "apply"), ("statistics", "value")):
        for word in words_in(folder):
            module = module_of(folder, word)
            assert callable(getattr(module, entry)), word
            assert module.__doc__ and module.__doc__.split("\n")[0].endswith((".", ":", ";")), word
    assert "at:T" in statistic.words()


def test_it_imports_nothing_of_the_mechanics() -> None:
    program = """
import sys
import crashsolve.channels.expression, crashsolve.channels.statistic
from crashsolve.channels.folder import module_of, words_in
for folder in ("functions", "statistics"):
    for word in words_in(folder):
        module_of(folder, word)
loaded = [name for name in sys.modules if name.startswith("crashsolve.")]
assert all(name.startswith("crashsolve.channels") for name in loaded), loaded
assert not {"numba", "scipy", "h5py", "pydantic", "pandas"} & set(sys.modules)
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
