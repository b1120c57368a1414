"""From rendered files to folders on disk, each replaced as a whole or not at all."""
