"""Arms of numbers: poses in floats, damped Newton from many starts."""
