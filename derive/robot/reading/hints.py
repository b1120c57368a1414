"""What people write from habit, from other tools or from paper, and what a robot file wants instead."""

import re
import unicodedata
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from derive.robot.expression import multiple_of_pi
from derive.robot.options.inverse import ROWS

_NUMBER = r"(?<![\w.])(?:\d+(?:\.\d*)?|\.\d+)"
_WORD = r"[A-Za-z][A-Za-z0-9_]*"
_IN_METRES = {"mm": Fraction(1, 1000), "cm": Fraction(1, 100), "dm": Fraction(1, 10), "in": Fraction(254, 10000)}
_RADIANS = "angles are in radians unless the file says units: {angle: deg}"


def _degrees(found: re.Match[str]) -> str:
    angle = found["number"]
    return f"write {angle} and units: {{angle: deg}} for the whole file, or {multiple_of_pi(Fraction(angle) / 180)}"


def _length(found: re.Match[str]) -> str:
    number, unit = found["number"], found["unit"]
    millimetres = f", or {number} and units: {{length: mm}} for the whole file" if unit == "mm" else ""
    return f"write {float(Fraction(number) * _IN_METRES[unit]):.10g}, in metres{millimetres}"


def _unit(found: re.Match[str]) -> str:
    number, unit = found["number"], found["unit"]
    product = f"; for a product write {number}*{unit}" if unit in ("m", "g", "s", "N") else ""
    return f"write {number}: numbers are in SI units{product}"


def _in_letters(found: re.Match[str]) -> str:
    """The whole cell with Greek letters by their names and other characters in their plain form."""
    plain = ""
    for character in found.string:
        name = unicodedata.name(character, "")
        if name.startswith("GREEK") and "LETTER " in name:
            plain += name.split("LETTER ")[1].split()[0].lower()
        else:
            plain += unicodedata.normalize("NFKC", character).translate(_PLAIN_SIGNS)
    return f"write {plain}" if plain.isascii() else ""


# Fraction slash, minus and dashes, middle dot, multiplication and division signs, and the space that never breaks.
_PLAIN_SIGNS = {0x2044: "/", 0x2212: "-", 0x2013: "-", 0x2014: "-", 0xB7: "*", 0xD7: "*", 0xF7: "/", 0xA0: " "}
# Patterns in a cell that was refused, the first that is found decides; and what to write.
_CELLS: tuple[tuple[str, Callable[[re.Match[str]], str] | str], ...] = (
    (r"^\s*[-+]?\.(?i:nan|inf)\s*$", "write a finite number"),
    (r"[$\\]|[_^]\{", "LaTeX is not read here: write a1 for a_{1}, alpha for \\alpha, pi/2 for \\frac{\\pi}{2}"),
    (rf"(?P<number>{_NUMBER})\s*(?:°|º|deg(?:rees?)?\b)", _degrees),
    (r"°|º", "leave the sign out; units: {angle: deg} makes plain numbers degrees"),
    (r"[\w)]\s+rad(?:ians?)?\s*$|\drad(?:ians?)?\s*$", f"leave the unit out: {_RADIANS}"),
    (rf"(?P<number>{_NUMBER})\s*(?P<unit>{'|'.join(_IN_METRES)})\b", _length),
    (rf"(?P<number>{_NUMBER})\s*(?P<unit>kg|Nm|m|g|s|N)\b", _unit),
    (r"(?P<head>\d{1,3}),(?P<tail>\d{3}\.\d+)\b", lambda m: f"write {m['head']}{m['tail']}, without the comma"),
    (r"(?<![\w.])(?P<head>\d*),(?P<tail>\d+)", lambda m: f"write {m['head'] or 0}.{m['tail']}, with a decimal point"),
    (
        rf"\b(?:np|numpy|math|sympy|sp|cmath)\.(?={_WORD})",
        lambda m: f"write {m.string.replace(m[0], '')}, without the module",
    ),
    (rf"\b(?:deg2rad|radians|deg|d2r)\s*\(\s*(?P<number>{_NUMBER})\s*\)", _degrees),
    (
        r"\b(?:arc(?:sin|cos|tan)|a(?:sin|cos|tan)2?)\b",
        "inverse functions are not available; write the angle, or a name with its number under parameters",
    ),
    (rf"\b(?P<f>sin|cos|tan|sqrt)\s+(?P<x>{_WORD}|{_NUMBER})", lambda m: f"write {m['f']}({m['x']})"),
    (r"[^\x00-\x7f\u00b2\u00b3\u221a\u2019]", _in_letters),
)


def cell_hint(text: str) -> str:
    """What to write instead of a cell that was refused."""
    for pattern, hint in _CELLS:
        if (found := re.search(pattern, text)) and (said := hint if isinstance(hint, str) else hint(found)):
            return said
    return ""


# What a block looks like, for one that has another shape.
_BLOCKS: dict[str, str] = {
    "com": "write com: [x, y, z], in the link's own frame",
    "gravity": "write the vector, for instance gravity: [0, 0, -9.81]",
    "units": "write units: {angle: deg, length: mm}, or leave units out for rad and m",
    "friction": "write friction: {viscous: ..., coulomb: ...}",
    "coulomb": "write coulomb: f, or coulomb: [f_plus, f_minus] where friction differs by direction",
    "motor": "write motor: {mass: ..., inertia: ..., ratio: ...}, or armature: ... for a reflected inertia",
    "joints": "write one row per joint, for instance - {type: revolute, a: 0.4, alpha: pi/2}",
    "links": "write one row per joint, for instance - {mass: m1, com: [0, 0, 0], inertia: {zz: I1}}",
    "ends": "write ends: {left: NAME, right: NAME}, each with the row on which it is",
    "root": "write root: {type: planar}, or root: {type: floating}",
    "parameters": "write parameters: {a1: 0.4}; names without a number need no entry",
}
_SYMMETRIC = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


def shape_hint(key: str, value: Any) -> str:
    """What to write instead of a block of another shape, with the user's own numbers where they are clear."""
    if key in ("limits", "inertia"):
        return _limits(value) if key == "limits" else _inertia(value)
    if key == "row" and isinstance(value, list) and len(value) == 4:
        return "name the cells, for instance {type: revolute, theta: q1, d: 0, a: 1, alpha: 0}"
    if key == "join":
        return "name two rows, or a row and base; a third one is joined by a loop of its own"
    if key in ("runtime", "wrench") and isinstance(value, str):
        return f"write {key}: [{value}]"
    if key in ("com", "gravity") and isinstance(value, list) and len(value) < 3:
        return "write zeros where nothing else is"
    if key in ("com", "gravity") and isinstance(value, dict) and value.keys() <= {"x", "y", "z"}:
        return f"write {key}: [{', '.join(str(value.get(axis, 0)) for axis in 'xyz')}]"
    if key in ("base", "tool", "mount"):
        if isinstance(value, list) and len(value) == 3 and all(isinstance(entry, str) for entry in value):
            rows = [f"[{', '.join('1' if i == j else '0' for j in range(3))}, {value[i]}]" for i in range(3)]
            return f"for a translation write {key}: [{', '.join(rows)}, [0, 0, 0, 1]]"
        return f"write {key}: as four rows of four numbers, the last 0, 0, 0, 1"
    if key == "gravity" and isinstance(value, str) and re.fullmatch(_NUMBER, value.lstrip("+-")):
        return f"write the vector, for instance gravity: [0, 0, -{value.lstrip('+-')}] where z points up"
    return _BLOCKS.get(key, "")


def _limits(value: Any) -> str:
    """``180`` as ``[-180, 180]``, ``-90..90`` as ``[-90, 90]``."""
    if isinstance(value, dict):
        low, high = (next((value[k] for k in keys if isinstance(value.get(k), str)), "") for keys in _ENDS)
        return f"write limits: [{low or 'lower'}, {high or 'upper'}]"
    text = (value[0] if isinstance(value, list) and len(value) == 1 else value) if value else ""
    if not isinstance(text, str):
        return "write limits: [lower, upper]"
    if bound := re.fullmatch(rf"(?:±|\+-|\+/-)?\s*({_NUMBER}|pi(?:/\d+)?)", text.strip()):
        return f"write limits: [-{bound[1]}, {bound[1]}], or whatever the lower limit is"
    end = r"[+-]?\d+(?:\.\d+)?"
    pair = re.fullmatch(rf"[\[(]?\s*({end})\s*(?:\.\.+|,|;|to|\s)\s*({end})\s*[\])]?", text.strip())
    return f"write limits: [{pair[1]}, {pair[2]}]" if pair else "write limits: [lower, upper]"


_ENDS = (("min", "lower", "low", "from"), ("max", "upper", "high", "to"))


def _inertia(value: Any) -> str:
    """A matrix, or the principal moments, as the keys that an inertia has."""
    matrix = isinstance(value, list) and len(value) == 3
    if matrix and all(isinstance(row, list) and len(row) == 3 for row in value):
        entries = {key: value[i][j] for key, (i, j) in _SYMMETRIC.items()}
        if all(isinstance(entry, str) for entry in entries.values()):
            shown = ", ".join(f"{key}: {entry}" for key, entry in entries.items() if key[0] == key[1] or entry != "0")
            return f"write inertia: {{{shown}}}, about the centre of mass"
    if matrix and all(isinstance(entry, str) for entry in value):
        return f"write inertia: {{xx: {value[0]}, yy: {value[1]}, zz: {value[2]}}}, about the centre of mass"
    if isinstance(value, str):
        return f"write inertia: {{zz: {value}}}, or xx, yy, zz, about the centre of mass"
    return "write inertia: {xx: ..., yy: ..., zz: ..., xy: ..., xz: ..., yz: ...}, about the centre of mass"


# Keys that people bring from other tools, and what to write instead.
_KEYS = {
    **dict.fromkeys(("offset", "theta0"), "write it into the cell, for instance theta: q1 + pi/2"),
    "sigma": "write type: revolute or type: prismatic",
    "m": "write mass",
    "I": "write inertia: {xx: ..., yy: ..., zz: ...}",
    **dict.fromkeys(("Jm", "G"), "write motor: {inertia: ..., ratio: ...} or armature"),
    "B": "write friction: {viscous: ...}",
    "Tc": "write friction: {coulomb: [f_plus, f_minus]}, both magnitudes",
    "qlim": "write limits: [lower, upper]",
    "yx": "write xy",
    "zx": "write xz",
    "zy": "write yz",
    "<<": "merge keys are not supported; write the values out",
}
_KEYS_OF_A_JOINT = {
    **dict.fromkeys(("r", "s"), "write d, the offset along z"),
    "l": "write a, the length along x",
    **dict.fromkeys(("joint", "kind"), "write type"),
    **dict.fromkeys(("name", "var"), "write q: the name of the joint variable"),
    **dict.fromkeys(("min", "max"), "write limits: [lower, upper]"),
}

_KEYS_OF_A_LINK = {
    **dict.fromkeys(("r", "rc", "center_of_mass", "centre_of_mass"), "write com"),
    "rotor": "write motor",
    "tensor": "write inertia",
}


def key_hint(key: str, block: str, allowed: Sequence[str]) -> str:
    """What to write instead of an unknown key."""
    word, colon, value = key.partition(":")
    if colon and word in allowed:
        return f"put a space after the colon: '{word}: {value}'" if value else "remove one colon"
    return {"joints": _KEYS_OF_A_JOINT, "links": _KEYS_OF_A_LINK}.get(block, {}).get(key) or _KEYS.get(key, "")


# Other words for what may be chosen, by key.
_CHOICES: dict[str, dict[str, str]] = {
    "type": {
        **dict.fromkeys(("r", "rot", "rotary", "rotational", "rotation", "hinge", "continuous", "rotoid"), "revolute"),
        **dict.fromkeys(("rev", "0"), "revolute"),
        **dict.fromkeys(("p", "t", "lin", "linear", "translational", "slide", "slider", "sliding", "1"), "prismatic"),
        **dict.fromkeys(("free", "free-flyer", "freeflyer", "6dof"), "floating"),
    },
    "convention": {
        **dict.fromkeys(("dh", "sdh", "classic", "classical", "distal", "paul", "spong", "siciliano"), "standard"),
        **dict.fromkeys(("mdh", "craig", "khalil", "proximal", "khalil-kleinfinger"), "modified"),
    },
    "angle": dict.fromkeys(("degrees", "degree", "d", "°"), "deg") | dict.fromkeys(("radians", "radian", "r"), "rad"),
    "length": dict.fromkeys(("millimetre", "millimetres", "millimeter", "millimeters"), "mm")
    | dict.fromkeys(("metre", "metres", "meter", "meters"), "m"),
}


def choice_hint(key: str, text: str, choices: Sequence[str]) -> str:
    """What to write instead of a word that is not among those allowed."""
    said = _CHOICES.get(key, {}).get(text.strip().casefold(), "")
    if said in choices:
        return f"write {key}: {said}"
    word = said or text.casefold()
    if key == "type" and word in ("planar", "floating"):
        return f"a base that moves is no row: write root: {{type: {word}}}"
    if key == "length" and text.casefold() in ("cm", "in", "inch"):
        return "write the numbers in m or mm"
    rows = [word.casefold() for word in re.split(r"[\s,]+", text.strip())]
    return f"rows stand in a list: task: [{', '.join(rows)}]" if key == "task" and set(rows) <= set(ROWS) else ""


_TYPE = "type the table of its data sheet into a file that derive new NAME --joints N writes"
_IMPORT = "derive import makes a robot file of it: write derive import FILE -o NAME.yaml"
_XML = r"(?s)\s*(?:<\?xml.*?\?>\s*)?(?:<!--.*?-->\s*)*"  # what may stand before the first element
# How files begin that are no robot files, what they are, and what to do.
_FILES: tuple[tuple[str, str, str], ...] = (
    (rf"{_XML}<robot\b", "a URDF", _IMPORT),
    (rf"{_XML}<mujoco\b", "a MuJoCo model (MJCF)", f"it has no Denavit-Hartenberg table: {_TYPE}"),
    (rf"{_XML}<sdf\b", "an SDF model", f"it has no Denavit-Hartenberg table: {_TYPE}"),
    (r"(?is)\s*<(?:!doctype\s+)?html\b", "a web page", _TYPE),
    (r"\s*<", "an XML file", _TYPE),
    (r"%PDF-", "a PDF file", _TYPE),
    (r"\s*\\(?:documentclass|begin|usepackage|section|input)\b", "LaTeX", _TYPE),
    (r"(?m)\s*(?:from|import)\s+\w+.*$", "a Python program", _TYPE),
    (r"(?s).*\b(?:SerialLink|Link|DHRobot|RevoluteDH|rigidBodyTree)\s*\(", "a program", _TYPE),
    (r"\s*[\w.]+\s*[,;\t]\s*[\w.]+\s*[,;\t]\s*[\w.]+.*\n", "a table without keys", _TYPE),
)


def file_hint(text: str) -> tuple[str, str]:
    """What a file is that is no robot file."""
    return next(((what, remedy) for pattern, what, remedy in _FILES if re.match(pattern, text[:4000])), ("", ""))
