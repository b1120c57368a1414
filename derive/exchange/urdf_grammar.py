"""What is read of a URDF, and what of a file is not: told, or refused where it could change the arm."""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

from derive.errors import near_miss, quoted

if TYPE_CHECKING:
    from lxml import etree

# The attributes and the elements within each element that an arm is made of, as urdfdom reads them up to URDF 1.2.
READ: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = MappingProxyType(
    {
        "robot": (("name", "version"), ("link", "joint", "dh_table")),
        "link": (("name",), ("inertial",)),
        "inertial": ((), ("origin", "mass", "inertia")),
        "mass": (("value",), ()),
        "inertia": (("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), ()),
        "joint": (("name", "type"), ("parent", "child", "origin", "axis", "limit", "dynamics", "mimic")),
        "parent": (("link",), ()),
        "child": (("link",), ()),
        "origin": (("xyz", "rpy", "quat_xyzw"), ()),
        "axis": (("xyz",), ()),
        "limit": (("lower", "upper", "effort", "velocity"), ()),
        "dynamics": (("damping", "friction"), ()),
        "mimic": (("joint", "multiplier", "offset"), ()),
    }
)
# Elements that say where something is or what it weighs: what else stands in one may change that.
SHAPING = ("inertial", "mass", "inertia", "parent", "child", "origin", "axis")
# Words of names by which robots, links and joints would say such a thing, too.
WORDS = re.compile(
    r"(?<![a-z])(axis|child|com|density|frame|inertial?|length|mass|offset|orientation|origin|parent|pose|position|quat|"
    r"quaternion|rotation|rpy|scale|transform|translation|units?|xyz)(?![a-z])"
)
PASSED = ("link", "origin")  # a slip that is known and that no program reads: a link has no frame but its joint's
LABELS = ("name", "id", "comment")  # attributes that any element may have


def look(
    element: etree._Element,
    unread: Counter[str],
    note: Callable[[etree._Element, str], None],
    refused: Callable[[etree._Element, str, str, str], Exception],
) -> None:
    """Look at an element and at what is read within it; joints and links of a robot are looked at one by one."""
    tag, (attributes, elements) = str(element.tag), READ[str(element.tag)]
    if tag == "limit" and element.getparent().get("type", "").strip() == "continuous":
        attributes = ("effort", "velocity")
    for name, known in _unknown(element, attributes, elements):
        if _shapes(tag, name):
            remedy = near_miss(name, known) or "correct it, or leave it out where it changes nothing"
            found, allowed = f"{tag}: {quoted(name)} is not known, and could change the arm", ", ".join(known)
            raise refused(element, found, remedy, allowed and f"allowed: {allowed}")
        unread[quoted(name)[1:-1] + ("" if known is elements else f" of {tag}")] += 1
    within = Counter(child.tag for child in element)
    for child in () if tag == "robot" else [child for child in elements if child in within]:
        if within[child] > 1:
            note(element, f"{within[child]} elements {child} in one {tag}: the first is taken")
        look(element.find(child), unread, note, refused)


def _unknown(
    element: etree._Element, attributes: Sequence[str], elements: Sequence[str]
) -> Iterator[tuple[str, Sequence[str]]]:
    """Names in an element that nothing reads, and texts, with what might stand in their place."""
    yield from ((str(name), attributes) for name in element.attrib if name not in attributes)
    yield from ((str(child.tag), elements) for child in element if child.tag not in elements)
    texts = (element.text, *(child.tail for child in element))
    yield from ((text.strip(), ()) for text in texts if text and text.strip())


def _shapes(tag: str, name: str) -> bool:
    """Whether something unknown could say where something is or what it weighs; no name of a namespace does."""
    if ":" in name or "{" in name or name in LABELS or (tag, name) == PASSED:
        return False
    meant = WORDS.search(name.lower()) or difflib.get_close_matches(name.lower(), SHAPING, 1, 0.8)
    return tag in SHAPING or (tag in ("robot", "link", "joint") and bool(meant))
