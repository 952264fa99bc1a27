"""Kernels may be called from Python in the tests; runs of whole decks are separate processes."""

import os

os.environ.setdefault("CRASHSOLVE_CALL_KERNELS", "1")
