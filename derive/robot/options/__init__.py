"""Options of a robot file: style, handout, inverse kinematics, thresholds of its solutions."""
