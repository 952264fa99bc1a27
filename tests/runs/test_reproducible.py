"""Claim: a deck gives the same bits, whoever compiles it, and the same physics uncompiled."""

import os
from pathlib import Path

import numpy as np
import pytest
from command import crashsolve, datasets, differences, start

HERE = Path(__file__).parent
OSCILLATOR = HERE / "oscillator.yaml"
pytestmark = pytest.mark.xdist_group("runs")


@pytest.mark.long
def test_two_runs_that_compile_at_once_without_a_home_give_the_same_bits(tmp_path: Path) -> None:
    # nothing can be made below a file
    nowhere = {"HOME": os.devnull, "TMPDIR": str(tmp_path), "CRASHSOLVE_CACHE": ""}
    nowhere["XDG_CACHE_HOME"] = os.devnull
    folders = [tmp_path / "one", tmp_path / "other"]
    runs = [start(OSCILLATOR, "-o", folder, "--set", "limit=0.5", **nowhere) for folder in folders]
    for run in runs:
        _, errors = run.communicate(timeout=600)
        assert run.returncode == 0, errors
    assert list(tmp_path.glob("crashsolve-*"))
    assert differences(*folders) == []


def test_kernels_run_as_plain_python_give_the_same_history_to_round_off(
    mechanism: Path, tmp_path: Path
) -> None:
    compiled, plain = tmp_path / "compiled", tmp_path / "plain"
    short = ("--set", "end=0.24")  # the first blow falls at 0.226 s
    assert crashsolve(mechanism, "-o", compiled, *short).returncode == 0
    assert crashsolve(mechanism, "-o", plain, *short, CRASHSOLVE_PLAIN="1").returncode == 0
    a, b = datasets(compiled / "history.h5"), datasets(plain / "history.h5")
    assert a.keys() == b.keys()
    for name, values in a.items():
        if values.dtype == float and "residual" not in name and "error" not in name:
            scale = max(float(np.abs(values).max()), 1e-6)
            np.testing.assert_allclose(b[name], values, rtol=0, atol=1e-8 * scale, err_msg=name)
    assert a["rcforc/onsets"][-1, 0] == 1
