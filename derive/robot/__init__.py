"""The robot file: how a text becomes a `Robot`, exact, in SI units and radians.

`load` finds the text (a file, or a robot of the catalogue); `document` makes it a tree of texts with places; `schema`
checks keys and shapes; `parser` reads a cell to an `expression`, `cells` brings it to SI units; `table` and
`presentation` read the blocks; `validate` checks the whole. All that a text may cost is bounded in `size_limits`.
`description` is the data that results, with the options of `style`, and `robot` the class that everything else sees.
`names`, `evaluate` and `inertial_parameters` answer what is asked of it: its symbols, their numbers, and the parameters
in which torques are linear.
"""
