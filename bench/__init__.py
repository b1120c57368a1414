"""The harness of `make bench`: operation counts and times of generated code side by side with other tools."""
