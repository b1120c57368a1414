"""How people write it: the lecture form, and the shorthand of notes."""
