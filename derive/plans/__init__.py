"""The plan of a motion as data: points, path, profile, base, disturbance; the built-in plans."""
