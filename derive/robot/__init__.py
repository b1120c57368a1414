"""The robot file: how a text becomes a `Robot`, exact, in SI units and radians."""
