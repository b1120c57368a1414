"""What is written: one small module and one folder of templates for each language; knows no mechanics and no handout.

Every language goes through `kernel`, which turns a tape into statements; `target` says what a target is, `templating`
and `escape` how texts and users' words get into files. `native` builds on `c` and `numpy`, `casadi` on both as well.
"""
