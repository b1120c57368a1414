"""How the inverse kinematics is told: formulas in print, names of branches and postures, the workspace."""
