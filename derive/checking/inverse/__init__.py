"""Printed solutions of the inverse kinematics: how they are read, compared and repaired."""
