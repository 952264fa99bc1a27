# written by `python -m crashsolve.stubs` from the records of the law


