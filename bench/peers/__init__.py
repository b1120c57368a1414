"""Other tools, one module each. A tool that is not installed is left out; one that fails says so in its cell."""
