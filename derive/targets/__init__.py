"""What is written: a module and a folder of templates for each language; it knows no mechanics and no handout."""
