"""Where the Jacobian of an arm loses rank."""
