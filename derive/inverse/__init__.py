"""Inverse kinematics: from a table to a graph of elementary equations with every branch."""
