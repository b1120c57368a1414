"""Inverse kinematics, all branches: what derive generates, side by side with other closed-form solvers."""
