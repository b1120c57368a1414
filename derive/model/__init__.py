"""Every quantity of a robot in closed form."""
