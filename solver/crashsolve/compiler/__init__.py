"""From plain Python to machine code: specialise, translate, compile, keep. Knows no mechanics."""
