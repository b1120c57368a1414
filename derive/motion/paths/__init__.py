"""From points to trajectories: profiles on joints, ways of the hand, the fastest motion."""
