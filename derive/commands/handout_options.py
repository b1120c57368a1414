"""Options of ``derive handout`` that override the block ``handout:`` of the robot file."""

from __future__ import annotations

import argparse
from dataclasses import fields, replace
from enum import StrEnum

from derive.robot.handout import PARTS, Derivation, HandoutOptions, NotationOptions
from derive.robot.robot import Robot
from derive.robot.wording import listed, near_miss, quoted

_KINDS: dict[str, type[StrEnum]] = {field.name: type(field.default) for field in fields(NotationOptions)}  # type: ignore[misc]


def parts(text: str) -> tuple[str, ...]:
    """Names of parts separated by commas, in the order of the handout; underscores may stand for hyphens."""
    words = [word.strip().replace("_", "-") for word in text.split(",") if word.strip()]
    for word in words:
        if word not in PARTS:
            raise _unknown("part", word, PARTS)
    if not words:
        raise argparse.ArgumentTypeError(f"no part in {quoted(text)}; allowed: {listed(PARTS)}")
    return tuple(part for part in PARTS if part in words)


def notation(text: str) -> tuple[tuple[str, StrEnum], ...]:
    """``angle=vartheta,inertia=M`` as pairs of a name and its value."""
    return tuple(_choice(item.strip()) for item in text.split(",") if item.strip())


def _choice(item: str) -> tuple[str, StrEnum]:
    name, equals, value = (word.strip() for word in item.partition("="))
    if name not in _KINDS:
        raise _unknown("notation", name, _KINDS)
    allowed = [member.value for member in _KINDS[name]]
    if not equals or value not in allowed:
        raise _unknown(f"value of {name}", value, allowed)
    return name, _KINDS[name](value)


def _unknown(what: str, word: str, allowed: tuple[str, ...] | list[str] | dict[str, type[StrEnum]]) -> Exception:
    hint = near_miss(word, allowed)
    message = f"unknown {what} {quoted(word)}; allowed: {listed(allowed)}" + (f"; {hint}" if hint else "")
    return argparse.ArgumentTypeError(message)


def chosen_options(robot: Robot, arguments: argparse.Namespace) -> HandoutOptions:
    """What the robot file says, and over it what the command says."""
    options = robot.handout
    if arguments.parts is not None:
        options = replace(options, parts=arguments.parts)
    if arguments.lang is not None:
        options = replace(options, language=arguments.lang)
    if arguments.derivation is not None:
        options = replace(options, derivation=Derivation(arguments.derivation))
    for choices in arguments.notation or ():
        options = replace(options, notation=replace(options.notation, **dict(choices)))
    return options
