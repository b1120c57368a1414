"""The generated functions, one module per subject."""
