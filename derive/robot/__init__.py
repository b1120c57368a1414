"""The robot file: grammar, positions, schema, catalogue and the frozen `Robot`."""
