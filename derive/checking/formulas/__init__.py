"""A printed formula: how it is read, compared, diagnosed and changed."""
