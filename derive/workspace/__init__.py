"""The workspace of an arm: where a point of it gets to within the joints' limits, its true boundary, and its size."""
