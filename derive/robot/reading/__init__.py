"""A robot file as a tree of texts with places: structure, limits on size, hints."""
