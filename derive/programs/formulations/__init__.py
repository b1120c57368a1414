"""The formulations of each generated function: the recursions and closed forms among which the cheapest is chosen."""
