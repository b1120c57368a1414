"""An arm under a control law: steps in time, friction that sticks, stages of a plan."""
