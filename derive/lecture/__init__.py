"""How people write it: the lecture form, its plan, and the shorthand of notes."""
