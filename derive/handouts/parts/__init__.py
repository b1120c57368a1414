"""The parts of the handout: from the context to a section."""
