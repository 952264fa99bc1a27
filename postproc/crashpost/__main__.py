"""`python -m crashpost` is the command `crashpost`."""

import sys

from crashpost.cli import main

sys.exit(main())
