"""Exact trigonometric polynomials over angles, variables and parameters. Knows no robot mechanics.

`generators` says what the variables of the polynomials stand for, `ring` computes with them modulo s^2 + c^2 = 1 and
the like (`Ring.relate_angle`), `domain` is the ring of one robot and the way of an expression into it. `contraction`
writes products of sines and cosines with sums of angles, `factors` factors, `quotients` decides whether formulas with
divisions are equal, `residues` computes modulo a prime. `constants` are numbers without variables.
"""
