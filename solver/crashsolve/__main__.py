"""`python -m crashsolve`."""

import sys

from crashsolve.cli import main

sys.exit(main())
