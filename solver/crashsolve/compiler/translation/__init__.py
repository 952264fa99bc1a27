"""Kernels to LLVM's language: the few words of Python that kernels use, with every kind known.

Kernels are functions of numbers, rows, columns and tables that allocate nothing and call each other
by name. So their kinds follow from those of the tables, function by function, and each is
translated in a few milliseconds. A word outside this language is refused with file and line.
"""
