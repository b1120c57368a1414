"""How books group and write the same expression: the keys ``style`` and ``contraction`` of a robot file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from enum import StrEnum
from typing import Annotated, Any, Final, TypeVar, cast

from derive.errors import QuantityError, listed, near_miss, quoted

Choice = TypeVar("Choice", bound=StrEnum)


class Contraction(StrEnum):
    """Which sums of joint angles are contracted."""

    ALIGNED = "aligned"  # those of parallel axes that point the same way: c12, s123
    OPPOSED = "opposed"  # those of antiparallel axes too: cos(q1 + q2 - q4)


def choice_named(kind: type[Choice], name: str, title: str = "") -> Choice:
    """The choice of that name."""
    try:
        return kind(name)
    except ValueError:
        allowed = f"allowed: {listed(tuple(member.value for member in kind))}"
        raise QuantityError(f"unknown {title or kind.__name__.lower()} {name!r}", allowed=allowed) from None


class Order(StrEnum):
    """What is grouped first in an entry without a length: of a rotation matrix, of the lower half of a Jacobian."""

    BASE = "base"  # the sines and cosines of the joints from the base outwards: c1*(c2*(c4*c5*c6 - s4*s6) - s2*s5*c6)
    BASE_EXPANDED = "base-expanded"  # those of the first joint alone: c1*(c2*c4*c5*c6 - c2*s4*s6 - s2*s5*c6) - s1*(...)
    TOOL = "tool"  # those of the joints from the tool inwards: c6*(c5*(...) - s5*(...)) - s6*(...)
    TOOL_EXPANDED = "tool-expanded"  # those of the last joint alone
    EXPANDED = "expanded"  # nothing: a sum of products


class LengthOrder(StrEnum):
    """What is grouped first in an entry with lengths: of a position, of the upper half of a Jacobian."""

    # as `BASE`; but where a length multiplies a direction in all brackets, such as the one from the wrist to the tool,
    # as `OFFSET` unless that costs two operations
    USUAL = "usual"
    BASE = "base"  # the joints from the base outwards, lengths inside the first bracket: c1*(a2*c2 + a3*c23)
    BASE_EXPANDED = "base-expanded"  # the first joint alone
    TOOL = "tool"  # the joints from the tool inwards
    TOOL_EXPANDED = "tool-expanded"  # the last joint alone
    # each offset d along a joint axis stands in front, the link lengths are nested from the base outwards: d6*(c1*s5 +
    # s1*c5) + c1*(a2*c2 + a3*c23) + d4*s1
    OFFSET = "offset"
    LENGTH = "length"  # each length, then the joints from the base outwards: d6*(c1*(c2*s5 + s2*c5) + s1) + c1*s2*q3
    LENGTH_TOOL = "length-tool"  # each length, then the joints from the tool inwards
    LENGTH_EXPANDED = "length-expanded"  # each length, what it multiplies expanded
    EXPANDED = "expanded"  # nothing: a sum of products


class ShortSums(StrEnum):
    """How a kinematic sum of at most three terms is written, the entry itself or what a length multiplies."""

    NESTED = "nested"  # as a longer one: c1*(a2*c2 + a3*c23)
    SHORT_ARMS = "short-arms"  # as a sum of products where no entry of the arm's T is longer, else nested
    POSITIONS = "positions"  # one with lengths as a sum of products: a2*c1*c2 + a3*c1*c23, but c1*(c2*c4 + s2*s4)
    EXPANDED = "expanded"  # any one as a sum of products


class Grouping(StrEnum):
    """What is grouped first in dynamics."""

    # torques of gravity by function; anything else of point masses by geometry, of bodies with moments of inertia by
    # body, in Christoffel symbols differences of moments of inertia by function: (Iy - Iz)*c2*s2
    USUAL = "usual"
    BODY = "body"  # masses and moments of inertia: m1*l1**2 + m2*(a1**2 + l2**2 + 2*a1*l2*c2)
    GEOMETRY = "geometry"  # each product of lengths and functions of q: (m1 + m2)*a1**2 + m2*a2**2 + 2*m2*a1*a2*c2
    FUNCTION = "function"  # each function of q, its coefficient a sum of products: (m1*l1 + m2*a1)*g*c1
    FUNCTION_BODY = "function-body"  # each function of q, its coefficient by masses and inertias
    # each function of q, its coefficient by products of lengths: (m1*l1 + (m2 + m3)*a1)*g*c1
    FUNCTION_GEOMETRY = "function-geometry"
    EXPANDED = "expanded"  # nothing: a sum of products


class Products(StrEnum):
    """Whether the coefficient of a body that is a product of sums stays one."""

    KEPT = "kept"  # m3*(a2*c2 + l3*c23)**2
    EXPANDED = "expanded"  # m3*(a2**2*c2**2 + 2*a2*l3*c2*c23 + l3**2*c23**2)


class CommonFactors(StrEnum):
    """Which common factors are taken out of the bracket of a body."""

    NONE = "none"  # none: m3*(a2*l3*c2*s23 + l3**2*c23*s23)
    FUNCTIONS = "functions"  # functions of q: m3*s23*(a2*l3*c2 + l3**2*c23)
    ALL = "all"  # lengths too: m3*l3*s23*(a2*c2 + l3*c23); of an entry by geometry, those of the whole


class GravityPlace(StrEnum):
    """Where the acceleration of gravity stands."""

    BRACKET = "bracket"  # in front of each bracket: m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)
    TERM = "term"  # in every term: (m1*g*l1 + m2*g*a1)*c1 + m2*g*l2*c12
    OUTSIDE = "outside"  # in front of the whole: g*((m1*l1 + m2*a1)*c1 + m2*l2*c12)


class Kinetic(StrEnum):
    """How the kinetic energy is written."""

    MATRIX = "matrix"  # by the entries of B: 1/2*B11*qd1**2 + B12*qd1*qd2 + 1/2*B22*qd2**2
    BODY = "body"  # by bodies: 1/2*m1*l1**2*qd1**2 + 1/2*m2*(a1**2*qd1**2 + l2**2*(qd1 + qd2)**2 + ...)


class Rates(StrEnum):
    """How velocities and accelerations are collected."""

    USUAL = "usual"  # a coefficient of one term as `SYMBOL`, of several as `PRODUCT`
    PRODUCT = "product"  # each product of rates with its coefficient: -2*h*qd1*qd2 - h*qd2**2
    SYMBOL = "symbol"  # each coefficient (a Christoffel symbol, an entry of B) with its rates: -h*(2*qd1*qd2 + qd2**2)
    FACTORED = "factored"  # the same, a common velocity in front: -h*qd2*(2*qd1 + qd2)
    TERM = "term"  # each term of the coefficients with its rates: m2*l2**2*(qdd1 + qdd2) + m2*a1*l2*c2*(2*qdd1 + qdd2)
    # the same, in each bracket every product of rates with its masses: a1*l2*c2*((m2 + 2*m3)*qdd1 + (m2/2 + m3)*qdd2)
    GEOMETRY = "geometry"
    EXPANDED = "expanded"  # multiplied out


class Brackets(StrEnum):
    """Which bodies' coefficients stand in brackets, apart from torques of gravity, where all do."""

    ALL = "all"  # all sums: m2*(l2**2 + a1*l2*c2) + I2
    LONG = "long"  # sums of three terms or more: m2*l2**2 + m2*a1*l2*c2 + I2, but m2*(a1**2 + l2**2 + 2*a1*l2*c2)


@dataclass(frozen=True, slots=True)
class Style:
    """How a book writes its expressions: what it groups first in every kind of quantity.

    Each option is independent of the others; `NAMED_STYLES` are the usual sets of them. A value may be given by its
    name, ``Style.of("gravity: body")``.
    """

    rotations: Annotated[Order, "Kinematic entries without a length: from base or tool."] = Order.BASE
    positions: Annotated[LengthOrder, "Those with lengths: from base, tool, by length."] = LengthOrder.USUAL
    short: Annotated[ShortSums, "Whether kinematic sums of up to three terms are nested."] = ShortSums.NESTED
    inertia: Annotated[Grouping, "What is grouped first in the inertia matrix."] = Grouping.USUAL
    christoffel: Annotated[Grouping, "What is grouped first in Christoffel symbols."] = Grouping.USUAL
    gravity: Annotated[Grouping, "What is grouped first in torques of gravity."] = Grouping.USUAL
    # as in B and Christoffel symbols if `USUAL`
    torques: Annotated[Grouping, "What is grouped first in the coefficients of torques."] = Grouping.USUAL
    potential: Annotated[Grouping, "What is grouped first in the potential energy."] = Grouping.USUAL
    kinetic: Annotated[Kinetic, "Kinetic energy by entries of B, or by bodies."] = Kinetic.MATRIX
    products: Annotated[Products, "Whether products of sums stay products."] = Products.KEPT
    brackets: Annotated[Brackets, "Which bodies' coefficients stand in brackets."] = Brackets.ALL
    factors: Annotated[CommonFactors, "What is taken out of a body's bracket."] = CommonFactors.FUNCTIONS
    g: Annotated[GravityPlace, "Gravity in every term, or in front of more."] = GravityPlace.BRACKET
    coriolis: Annotated[Rates, "How rates are collected in C, N and dB/dt."] = Rates.SYMBOL
    velocities: Annotated[Rates, "How products of velocities are collected in torques."] = Rates.USUAL
    accelerations: Annotated[Rates, "How accelerations are collected in torques."] = Rates.PRODUCT
    contraction: Annotated[Contraction, "Which sums of joint angles are contracted."] = Contraction.ALIGNED

    @classmethod
    def of(cls, value: Style | str | Mapping[str, str]) -> Style:
        """A style in any of the ways in which one can be given."""
        if isinstance(value, Style):
            return value
        changes = {} if isinstance(value, str) else dict(value)
        if isinstance(value, str):
            for part in value.split(","):  # a word without a colon is the name of a set
                key, colon, word = (each.strip() for each in part.replace("=", ":").partition(":"))
                key, word = (key, word) if colon else ("name", key)
                if key in changes:
                    raise QuantityError(f"{quoted(key)} twice in style {quoted(value)}", remedy="remove one")
                changes[key] = word
        start = changes.pop("name", DEFAULT_STYLE)
        if start not in NAMED_STYLES:
            allowed = f"allowed: {listed(NAMED_STYLES)}, or options such as gravity: body"
            remedy = near_miss(start, NAMED_STYLES)
            raise QuantityError(f"unknown style {quoted(start)}", allowed=allowed, remedy=remedy)
        chosen: dict[str, Any] = {}
        for name, text in changes.items():
            if name not in STYLE_OPTIONS:
                allowed, remedy = f"allowed: {listed(STYLE_OPTIONS)}", near_miss(name, STYLE_OPTIONS)
                raise QuantityError(f"unknown style option {quoted(name)}", allowed=allowed, remedy=remedy)
            chosen[name] = choice_named(STYLE_OPTIONS[name], text, f"{name} of a style")
        return replace(NAMED_STYLES[start], **chosen)

    def changed(self, values: Mapping[str, StrEnum]) -> Style:
        """The style with other values of some options."""
        return replace(self, **cast(Mapping[str, Any], values))

    def options(self) -> dict[str, str]:
        """The fewest options that say the style: a set under ``name``, if not the default one, and what it changes."""
        ways = []
        for name, start in NAMED_STYLES.items():
            values = {option.name: getattr(self, option.name) for option in fields(self)}
            changes = {key: str(value) for key, value in values.items() if value != getattr(start, key)}
            ways.append(changes if name == DEFAULT_STYLE else {"name": name, **changes})
        return min(ways, key=len)

    def __str__(self) -> str:
        """The style as `of` reads it: ``by-geometry, gravity: body``."""
        options = self.options()
        name = options.pop("name", "" if options else DEFAULT_STYLE)
        return ", ".join([*([name] if name else []), *(f"{key}: {value}" for key, value in options.items())])


DEFAULT_STYLE: Final = "compact"  # name of the set that holds where a file says nothing

STYLE_OPTIONS: Mapping[str, type[StrEnum]] = {
    option.name: cast(type[StrEnum], type(option.default)) for option in fields(Style)
}
"""Every option of a style and its values."""

_OF_DYNAMICS = ("inertia", "christoffel", "gravity", "potential")
_EXPANDED = ("rotations", "positions", *_OF_DYNAMICS, "products", "coriolis", "velocities", "accelerations")
_BY_GEOMETRY = {"positions": "length", "products": "expanded", "velocities": "symbol"}
_CHANGES: Mapping[str, Mapping[str, str]] = {
    DEFAULT_STYLE: {},
    "by-geometry": dict.fromkeys(_OF_DYNAMICS, "geometry") | _BY_GEOMETRY,
    "expanded": dict.fromkeys(_EXPANDED, "expanded"),
}
NAMED_STYLES: Mapping[str, Style] = {
    name: Style().changed({option: STYLE_OPTIONS[option](word) for option, word in changes.items()})
    for name, changes in _CHANGES.items()
}
"""The usual sets of options by their names."""
