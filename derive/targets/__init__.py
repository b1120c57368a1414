"""One small module and one template folder per language; knows no mechanics and no handout."""
