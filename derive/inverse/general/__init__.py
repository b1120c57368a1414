"""General arms of six joints: elimination to an eigenvalue problem, and how many solutions there are."""
