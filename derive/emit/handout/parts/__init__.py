"""The parts of the handout, one module each: from the context to a section."""
