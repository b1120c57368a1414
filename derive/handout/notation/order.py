"""The order of terms and factors that textbooks use.

Factors: number, ratios, masses and inertias, other parameters, prismatic variables, cosines and sines by joint,
brackets, velocities, accelerations. Terms: accelerations before velocities before the rest, then by inertial
parameter, terms without cosines and sines before those with, by joint from the base outwards, cosine before sine,
then by parameter; multiples of pi last. Equal keys keep the order of the expression.
"""

from __future__ import annotations

from typing import Any

from sympy import pi

from derive.handout.notation.notation import Notation

FactorKey = tuple[int, tuple[int, ...], str, float]
FactorKeys = tuple[FactorKey, ...]
TermKey = tuple[int, FactorKeys, tuple[int, ...], FactorKeys, FactorKeys, FactorKeys]

_NUMBER, _UNKNOWN, _INERTIAL, _PARAMETER, _OFFSET = range(5)
_TRIGONOMETRIC, _OTHER, _BRACKET, _VELOCITY, _ACCELERATION = range(5, 10)
_CLASS_OF_POSITION = (_PARAMETER, _OFFSET, _VELOCITY, _ACCELERATION)


class Order:
    """Sort keys for the expressions of one robot.

    Args:
        notation: The robot's notation.
    """

    def __init__(self, notation: Notation) -> None:
        self._notation = notation
        self._bases: dict[Any, tuple[int, tuple[int, ...], str]] = {}
        self._factors: dict[Any, FactorKey] = {}
        self._terms: dict[Any, TermKey] = {}

    def factor(self, factor: Any) -> FactorKey:
        """Sort key of a factor of a product."""
        known = self._factors.get(factor)
        if known is None:
            known = self._factors[factor] = self._factor(factor)
        return known

    def _factor(self, factor: Any) -> FactorKey:
        base, exponent = factor.as_base_exp()
        found = self._bases.get(base)
        if found is None:
            found = self._bases[base] = self._base(base)
        return (*found, float(exponent) if exponent.is_number else 0.0)

    def term(self, term: Any) -> TermKey:
        """Sort key of a term of a sum."""
        found = self._terms.get(term)
        if found is None:
            found = self._terms[term] = self._term(term)
        return found

    def _base(self, base: Any) -> tuple[int, tuple[int, ...], str]:
        if base.is_Symbol and base.name in self._notation.inertial:
            return (_INERTIAL, (self._notation.inertial[base.name],), "")
        if base.is_Symbol:
            position = self._notation.positions.get(base.name)
            if position is None:
                return (_UNKNOWN, (), base.name)
            return (_CLASS_OF_POSITION[position[0]], (position[1],), "")
        if base.is_Number or base.is_NumberSymbol:
            return (_NUMBER, (), str(base))
        name = getattr(base.func, "__name__", "")
        if name in ("cos", "sin"):
            return self._circular(name, base.args[0])
        if not base.is_Add:
            return (_OTHER, (), str(base))
        return (_VELOCITY if self._moves(base) else _BRACKET, (), "")

    def _moves(self, bracket: Any) -> bool:
        """Whether a bracket holds velocities or accelerations only."""
        positions = self._notation.positions
        return all(positions.get(symbol.name, (0, 0))[0] >= 2 for symbol in bracket.free_symbols)

    def _circular(self, name: str, angle: Any) -> tuple[int, tuple[int, ...], str]:
        positions = self._notation.positions
        places = [positions.get(symbol.name, (0, 0)) for symbol in angle.free_symbols]
        joints = tuple(sorted(index for rank, index in places if rank == 1))
        plain = joints and (angle.is_Symbol or all(term.is_Symbol for term in angle.args))
        return (_TRIGONOMETRIC, joints, name if plain else f"{angle} {name}")

    def _term(self, term: Any) -> TermKey:
        rest = term.as_coeff_Mul()[1]
        factors = rest.args if rest.is_Mul else (rest,)
        keys = sorted(self.factor(factor) for factor in factors)
        motion = tuple(key for key in keys if key[0] >= _VELOCITY)
        trigonometric = tuple(key for key in keys if key[0] == _TRIGONOMETRIC)
        plain = tuple(key for key in keys if key[0] < _TRIGONOMETRIC)
        brackets = tuple(key for key in keys if key[0] in (_OTHER, _BRACKET))
        rank = -keys[-1][0] if motion else int(rest.has(pi))
        return (rank, motion, self._inertial(factors), trigonometric, plain, brackets)

    def _inertial(self, factors: tuple[Any, ...]) -> tuple[int, ...]:
        inertial = self._notation.inertial
        bases = [factor.as_base_exp()[0] for factor in factors]
        return tuple(sorted(inertial[base.name] for base in bases if base.is_Symbol and base.name in inertial))
