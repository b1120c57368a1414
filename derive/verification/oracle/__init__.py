"""The independent recursion: every generated function once more, in plain NumPy floats, from the definitions."""
