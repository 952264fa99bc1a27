"""Another word for resultant."""

from crashsolve.channels.functions.resultant import apply as apply
