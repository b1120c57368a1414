"""What a log says of a robot: base parameters, and the robot file that has them."""
