"""From plain Python to machine code: specialise, translate, compile, store. It contains no
mechanics.
"""
