"""`python -m crashpost` does what the command `crashpost` does."""

import sys

from crashpost.cli import main

sys.exit(main())
