"""The order of terms and factors that textbooks use.

Factors: number, ratios, masses and inertias, other parameters, prismatic variables, cosines and sines by joint,
brackets, velocities, accelerations. Terms: accelerations before velocities before the rest, then by inertial
parameter, terms without cosines and sines before those with, by joint from the base outwards, cosine before sine,
then by parameter; multiples of pi last. Equal keys keep the order of the expression.
"""

from __future__ import annotations

from typing import Any

from sympy import pi

from derive.handouts.notation.notation import Notation

BaseKey = tuple[int, tuple[int, ...], str]
FactorKey = tuple[int, tuple[int, ...], str, float]
FactorKeys = tuple[FactorKey, ...]
TermKey = tuple[int, FactorKeys, tuple[int, ...], FactorKeys, FactorKeys, FactorKeys]

_NUMBER, _UNKNOWN, _INERTIAL, _PARAMETER, _OFFSET = range(5)
_TRIGONOMETRIC, _OTHER, _BRACKET, _VELOCITY, _ACCELERATION = range(5, 10)
_CLASS_OF_POSITION = (_PARAMETER, _OFFSET, _VELOCITY, _ACCELERATION)
_NO_POSITION = (0, 0)


class Order:
    """Sort keys for the expressions of one robot.

    Args:
        notation: The robot's notation.
    """

    def __init__(self, notation: Notation) -> None:
        self._positions = notation.positions
        self._inertial = notation.inertial
        self._bases: dict[Any, BaseKey] = {}
        self._factors: dict[Any, FactorKey] = {}
        self._terms: dict[Any, TermKey] = {}

    def factor(self, factor: Any) -> FactorKey:
        """Sort key of a factor of a product.

        Args:
            factor: A SymPy expression.
        """
        known = self._factors.get(factor)
        if known is None:
            base, exponent = factor.as_base_exp()
            if base not in self._bases:
                self._bases[base] = self._base(base)
            known = self._factors[factor] = (*self._bases[base], float(exponent) if exponent.is_number else 0.0)
        return known

    def term(self, term: Any) -> TermKey:
        """Sort key of a term of a sum.

        Args:
            term: A SymPy expression.
        """
        known = self._terms.get(term)
        if known is None:
            known = self._terms[term] = self._term(term)
        return known

    def _base(self, base: Any) -> BaseKey:
        if base.is_Symbol and base.name in self._inertial:
            return (_INERTIAL, (self._inertial[base.name],), "")
        if base.is_Symbol:
            position = self._positions.get(base.name)
            if position is None:
                return (_UNKNOWN, (), base.name)
            return (_CLASS_OF_POSITION[position[0]], (position[1],), "")
        if base.is_Number or base.is_NumberSymbol:
            return (_NUMBER, (), str(base))
        name = getattr(base.func, "__name__", "")
        positions = [self._positions.get(symbol.name, _NO_POSITION) for symbol in base.free_symbols]
        if name in ("cos", "sin"):
            angle = base.args[0]
            joints = tuple(sorted(index for rank, index in positions if rank == 1))
            plain = joints and (angle.is_Symbol or all(term.is_Symbol for term in angle.args))
            return (_TRIGONOMETRIC, joints, name if plain else f"{angle} {name}")
        if not base.is_Add:
            return (_OTHER, (), str(base))
        moves = all(rank >= 2 for rank, _ in positions)
        return (_VELOCITY if moves else _BRACKET, (), "")

    def _term(self, term: Any) -> TermKey:
        rest = term.as_coeff_Mul()[1]
        factors = rest.args if rest.is_Mul else (rest,)
        bases = [factor.as_base_exp()[0] for factor in factors]
        inertial = sorted(self._inertial[base.name] for base in bases if base.is_Symbol and base.name in self._inertial)
        keys = sorted(self.factor(factor) for factor in factors)
        motion = tuple(key for key in keys if key[0] >= _VELOCITY)
        trigonometric = tuple(key for key in keys if key[0] == _TRIGONOMETRIC)
        plain = tuple(key for key in keys if key[0] < _TRIGONOMETRIC)
        brackets = tuple(key for key in keys if key[0] in (_OTHER, _BRACKET))
        rank = -keys[-1][0] if motion else int(rest.has(pi))
        return (rank, motion, tuple(inertial), trigonometric, plain, brackets)


def is_below(exponent: Any) -> bool:
    """Whether a power belongs into a denominator.

    Args:
        exponent: The SymPy exponent.
    """
    return bool(exponent.is_Rational and exponent < 0)
