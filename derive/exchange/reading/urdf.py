"""URDF files, read exactly, each element with its line.

What else stands in a file than an arm is made of is not read: it is told, or refused where it could change the arm.
"""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.errors import Location, RobotFileError, near_miss, optional, quoted
from derive.exchange.body_chain import roll_pitch_yaw
from derive.exchange.reading.elements import ZEROS, Origin, Triple, Urdf, UrdfBody, UrdfJoint
from derive.mechanics.space import WORLD, Frame, decimal, exactly, vector

if TYPE_CHECKING:
    from lxml import etree

MOST_BYTES = 16 * 2**20  # of a file; URDFs with thousands of links have less
MOST_ELEMENTS = 20_000  # links and joints of a robot
MOST_TAGS = 200_000  # of a file, opening and closing ones; they take the memory
MOST_DIGITS = 400  # of a number
GREATEST = 60  # power of ten beyond which a number is no length and no mass; what is as small is zero
VERSIONS = ("1.0", "1.1", "1.2")  # of URDF; a file that says none is of the first
ONE = Fraction(1, 10**6)  # how far the squared length of a quaternion may be from 1 without a word
MOST_ROOTS = 8  # of those that are named
DIGITS = 70  # of what is computed: the roll, pitch and yaw of a quaternion
_ENCODING = re.compile(rb"\s*<\?xml\s[^>]*encoding=[\"'](?!utf-8[\"'])", re.IGNORECASE)
_DECIMAL = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,6})?", re.ASCII)

# The attributes and the elements within each element that an arm is made of, as urdfdom reads them up to URDF 1.2.
READ: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
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
# Elements that say where something is or what it weighs: what else stands in one may change that.
SHAPING = ("inertial", "mass", "inertia", "parent", "child", "origin", "axis")
# Words of names by which robots, links and joints would say such a thing, too.
WORDS = re.compile(
    r"(?<![a-z])(axis|child|com|density|frame|inertial?|length|mass|offset|orientation|origin|parent|pose|position|quat|"
    r"quaternion|rotation|rpy|scale|transform|translation|units?|xyz)(?![a-z])"
)
PASSED = ("link", "origin")  # a slip that is known and that no program reads: a link has no frame but its joint's


def read_urdf(data: bytes, source: str) -> Urdf:
    """Read a URDF."""
    root, notes = _parsed(data, source)
    if root.tag != "robot":
        found, place = f"the outermost element is {quoted(str(root.tag))}", Location(source, root.sourceline or 1)
        remedy = "give a URDF, or an MJCF with --tree; a xacro file is read where its name ends with .xacro"
        raise RobotFileError(found, allowed="allowed: robot", remedy=remedy, location=place)
    reader = _UrdfReader(source, root.get("version", VERSIONS[0]))
    if reader.version not in VERSIONS:
        found = f"version {quoted(reader.version)} of URDF"
        raise reader.refused(root, found, 'write version="1.0", or leave it out', f"allowed: {', '.join(VERSIONS)}")
    elements = list(root.iterchildren("link", "joint"))
    if len(elements) > MOST_ELEMENTS:
        found = f"{len(elements)} links and joints"
        raise reader.refused(root, found, "give one robot", f"allowed: at most {MOST_ELEMENTS}")
    macro = next((child for child in root if re.match(r"\{[^}]*xacro", str(child.tag))), None)
    if macro is not None:
        found = f"an element {quoted('xacro:' + str(macro.tag).rpartition('}')[2])}"
        raise reader.refused(macro, found, "give it as a file: derive import expands xacro in files only")
    bodies: dict[str, UrdfBody | None] = {}
    joints: dict[str, UrdfJoint] = {}
    for element in sorted(elements, key=lambda element: element.tag == "joint"):  # joints name links
        kind, name = element.tag, reader.name(element)
        joint = reader.joint(element, name, bodies) if kind == "joint" else None
        if name in (bodies if joint is None else joints):
            raise reader.refused(element, f"a second {kind} {quoted(name)}", f"give each {kind} a name of its own")
        if joint is None:
            bodies[name] = reader.body(element)
        else:
            joints[name] = joint
    if not bodies:
        raise reader.refused(root, "a robot without links", "give a URDF with links and joints")
    if not root.get("name"):
        reader.note(root, "a robot without a name, which other programs refuse")
    for element in (root, *elements):
        reader.look(element)
    carried = {joint.child for joint in joints.values()}
    roots = [quoted(link) for link in bodies if link not in carried]
    some = f"{', '.join(roots[:MOST_ROOTS])}{', ...' if len(roots) > MOST_ROOTS else ''}"
    said = f"{len(roots)} links hang on no joint: {some}; other programs refuse such a file"
    notes += (*reader.notes, said) if len(roots) > 1 else tuple(reader.notes)
    notes += tuple(f"{fault} (line {joint.location.line})" for joint in joints.values() if (fault := joint.fault))
    points = [f"{quoted(name)} (line {body.location.line})" for name, body in bodies.items() if body and body.is_point]
    notes += (f"inertial without inertia, a mass at a point: link {', '.join(points)}",) if points else ()
    table = root.findtext("dh_table", "").strip()
    kinds = tuple(name for name, _ in reader.unread.most_common())
    return Urdf(root.get("name", ""), bodies, tuple(joints.values()), notes, kinds, source, table)


def _parsed(data: bytes, source: str) -> tuple[etree._Element, tuple[str, ...]]:
    """The tree without comments; entities and the network stay off."""
    etree = optional("lxml.etree", "reading URDF needs lxml", "exchange")
    if len(data) > MOST_BYTES:
        found = f"{source} has {len(data)} bytes"
        raise RobotFileError(found, allowed=f"allowed: at most {MOST_BYTES}", remedy="give the URDF without meshes")
    if (tags := data.count(b"<")) > MOST_TAGS:
        found, allowed = f"{source} has {tags} tags", f"allowed: at most {MOST_TAGS}"
        raise RobotFileError(found, allowed=allowed, remedy="give one robot")
    data, slips = _mended(data)
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True, remove_pis=True, recover=True
    )
    root = etree.fromstring(data, parser) if data.strip() else None
    unbound = etree.ErrorTypes.NS_ERR_UNDEFINED_NAMESPACE
    passed = {
        etree.ErrorTypes.ERR_HYPHEN_IN_COMMENT: "-- within XML comments",
        etree.ErrorTypes.ERR_UNKNOWN_VERSION: "a version of XML that does not exist",
    }
    errors = [error for error in parser.error_log if error.level > 1 and error.type not in (unbound, *passed)]
    slips += [said for kind, said in passed.items() if any(error.type == kind for error in parser.error_log)]
    has_types = root is not None and root.getroottree().docinfo.internalDTD is not None
    if has_types or (errors and b"<!DOCTYPE" in data):
        place = Location(source, data[: max(data.find(b"<!DOCTYPE"), 0)].count(b"\n") + 1)
        found = "a document type definition is not accepted"
        raise RobotFileError(found, remedy="write the file without DOCTYPE", location=place)
    if root is None or errors:
        found = " ".join(errors[0].message.split())[:120] if errors else "an empty file"
        place = Location(source, max(errors[0].line, 1), max(errors[0].column, 1)) if errors else Location(source)
        raise RobotFileError(f"not XML: {found}", remedy="give a well-formed URDF", location=place)
    prefixes = sorted({error.message.split()[2] for error in parser.error_log if error.type == unbound})
    slips += [f"the XML prefix {prefix} is not bound" for prefix in prefixes]
    # Elements without a prefix lose their namespace, as for other readers of URDF.
    spaces: dict[str, None] = {}
    for element in root.iter("{*}*"):
        if element.prefix is None and element.tag.startswith("{"):
            name, _, element.tag = element.tag[1:].rpartition("}")
            spaces[name] = None
    return root, (*slips, *(f"the XML namespace {quoted(name)} is passed over" for name in spaces))


def angles_of(x: Fraction, y: Fraction, z: Fraction, w: Fraction) -> Triple:
    """Roll, pitch and yaw of a quaternion of any length."""
    square = x * x + y * y + z * z + w * w
    # Columns of its rotation times the squared length.
    columns = (
        (w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)),
        (2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)),
        (2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z),
    )
    with exactly():
        axes = (vector([entry / square for entry in column]) for column in columns)
        roll, pitch, yaw = (decimal(angle, DIGITS) for angle in roll_pitch_yaw(Frame(WORLD.origin, *axes)))
    return roll, pitch, yaw


def _mended(data: bytes) -> tuple[bytes, list[str]]:
    """A file with slips mended over which other readers of URDF pass, with the same lines, and what they were."""
    slips = []
    if late := re.match(rb"(\s+)(<\?xml\s[^>]*\?>)", data):
        data = late[2] + late[1] + data[late.end() :]
        slips.append("space before the XML declaration")
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):  # UTF-16
        return data, slips
    whole = data.rstrip(b"\0\x1a\r\n\t ")
    if data[len(whole) :].strip():
        data = whole
        slips.append("control characters at the end of the file")
    if not _ENCODING.match(data):
        try:
            data.decode()
        except UnicodeDecodeError:
            data = data.decode("latin-1").encode()
            slips.append("not in UTF-8, read as Latin-1")
    return data, slips


@dataclass(frozen=True)
class _UrdfReader:
    source: str  # file name for messages
    version: str  # of URDF
    notes: list[str] = field(default_factory=list)  # what was read though it is not in order, as sentences
    unread: Counter[str] = field(default_factory=Counter)  # kinds of elements that were not read, and how often

    def note(self, element: etree._Element, said: str) -> None:
        self.notes.append(f"{said} (line {element.sourceline or 1})")

    def place(self, element: etree._Element) -> Location:
        return Location(self.source, element.sourceline or 1)

    def refused(self, element: etree._Element, found: str, remedy: str, allowed: str = "") -> RobotFileError:
        return RobotFileError(found, allowed=allowed, remedy=remedy, location=self.place(element))

    def name(self, element: etree._Element) -> str:
        if not (name := element.get("name", "").strip()):
            raise self.refused(element, f"a {element.tag} without a name", 'write name="..."')
        return str(name)

    def numbers(
        self, element: etree._Element | None, attribute: str, count: int, *, infinite: bool = False
    ) -> tuple[Fraction, ...] | None:
        """The decimals of an attribute; None where it or the element is not there."""
        if element is None or (text := element.get(attribute)) is None:
            return None
        words = text.split()
        if len(words) != count:
            found = f"{element.tag}, {attribute}: {len(words)} numbers, {quoted(text)}"
            raise self.refused(element, found, f"write {count}, apart by spaces", f"allowed: exactly {count}")
        return tuple(self._number(element, attribute, word, infinite) for word in words)

    def number(self, element: etree._Element | None, attribute: str, *, infinite: bool = False) -> Fraction | None:
        found = self.numbers(element, attribute, 1, infinite=infinite)
        return found[0] if found else None

    def _number(self, element: etree._Element, attribute: str, word: str, infinite: bool) -> Fraction:
        if _DECIMAL.fullmatch(word) and len(word) <= MOST_DIGITS:
            if (value := Decimal(word)) == 0 or value.adjusted() < -GREATEST:
                return Fraction(0)
            if value.adjusted() <= GREATEST:
                return Fraction(value)
            word = "-inf" if infinite and value < 0 else "inf" if infinite else word
        if infinite and re.fullmatch(r"[+-]?inf(inity)?", word, re.IGNORECASE):
            return Fraction((-1 if word[0] == "-" else 1) * 10**GREATEST)
        found = f"{element.tag}, {attribute}: {quoted(word)} is no number"
        allowed = f"allowed: finite decimals below 1e{GREATEST}"
        remedy = "separate numbers by spaces alone" if "," in word else "write a decimal such as 0.42"
        if _DECIMAL.fullmatch(decimal := word.replace(",", ".")) and not word.endswith(","):
            remedy = f"write {decimal}"
        raise self.refused(element, found, remedy, allowed)

    def origin(self, element: etree._Element) -> Origin:
        if (child := element.find("origin")) is None:
            return Origin()
        xyz, rpy = (self.numbers(child, key, 3) for key in ("xyz", "rpy"))
        x, y, z = xyz or ZEROS
        roll, pitch, yaw = self._angles(child) if child.get("quat_xyzw") is not None else rpy or ZEROS
        return Origin((x, y, z), (roll, pitch, yaw))

    def _angles(self, origin: etree._Element) -> Triple:
        """Roll, pitch and yaw of a quaternion, which counts by its direction."""
        if self.version == VERSIONS[0]:
            remedy = 'write <robot version="1.1">, or rpy'
            raise self.refused(origin, "origin: quat_xyzw, which URDF 1.0 does not have", remedy)
        if origin.get("rpy") is not None:
            raise self.refused(origin, "origin: both rpy and quat_xyzw", "leave one out")
        x, y, z, w = self.numbers(origin, "quat_xyzw", 4) or ()
        square = x * x + y * y + z * z + w * w
        if not square:
            raise self.refused(origin, "origin, quat_xyzw: a quaternion of length 0", "write 0 0 0 1 for no rotation")
        if abs(square - 1) > ONE:
            self.note(origin, f"a quaternion of length {float(square) ** 0.5:.6g} is taken with length 1")
        return angles_of(x, y, z, w)

    def body(self, element: etree._Element) -> UrdfBody | None:
        """What a link weighs; None where nothing is said."""
        if (inertial := element.find("inertial")) is None:
            return None
        mass, tensor = inertial.find("mass"), inertial.find("inertia")
        if (value := self.number(mass, "value")) is None:
            raise self.refused(inertial, "inertial without a mass", 'write <mass value="..."/>')
        keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        moments = [self.number(tensor, key) for key in keys]
        entries = tuple(moment or Fraction(0) for moment in moments)
        missing = [key for key, moment in zip(keys, moments, strict=True) if moment is None]
        if tensor is not None and missing:
            self.note(tensor, f"inertia without {', '.join(missing)}, taken as 0")
        return UrdfBody(value, self.origin(inertial), entries, self.place(inertial), tensor is None)

    def joint(self, element: etree._Element, name: str, links: Mapping[str, object]) -> UrdfJoint:
        kind, ends = element.get("type", "").strip(), {}
        for end in ("parent", "child"):
            child = element.find(end)
            link = "" if child is None else child.get("link", "").strip()
            if link not in links:
                found = f"joint {quoted(name)}: {end} {quoted(link)} is no link of the file"
                raise self.refused(element, found, f'write <{end} link="..."/> with the name of a link')
            ends[end] = link
        axis = element.find("axis")
        x, y, z = (Fraction(1), *ZEROS[:2]) if axis is None else self.numbers(axis, "xyz", 3) or ZEROS
        limit, dynamics, mimic = (element.find(tag) for tag in ("limit", "dynamics", "mimic"))
        keys = ("lower", "upper", "effort", "velocity")
        lower, upper, effort, velocity = (self.number(limit, key, infinite=True) for key in keys)
        bounded = kind in ("revolute", "prismatic") and (lower is not None or upper is not None)
        if kind in ("revolute", "prismatic") and not bounded:
            said = f"joint {quoted(name)} is {kind} and has no limits, without which other programs refuse it"
            self.note(element, said)
        times, plus = (self.number(mimic, key) for key in ("multiplier", "offset"))
        dry, viscous = (self.number(dynamics, key) for key in ("friction", "damping"))
        return UrdfJoint(
            name=name,
            type=kind,
            parent=ends["parent"],
            child=ends["child"],
            origin=self.origin(element),
            axis=(x, y, z),
            limits=(lower or Fraction(0), upper or Fraction(0)) if bounded else None,
            effort=effort,
            velocity=velocity,
            damping=viscous or Fraction(0),
            friction=dry or Fraction(0),
            mimics=None if mimic is None else mimic.get("joint", ""),
            location=self.place(element),
            multiplier=Fraction(1) if times is None else times,
            offset=plus or Fraction(0),
        )

    def look(self, element: etree._Element) -> None:
        """Look at an element and at what is read within it; joints and links of a robot are looked at one by one."""
        tag, (attributes, elements) = str(element.tag), READ[str(element.tag)]
        if tag == "limit" and element.getparent().get("type", "").strip() == "continuous":
            attributes = ("effort", "velocity")
        # Names in an element that nothing reads, and texts, with what might stand in their place.
        unknown: list[tuple[str, Sequence[str]]] = []
        unknown += ((str(name), attributes) for name in element.attrib if name not in attributes)
        unknown += ((str(child.tag), elements) for child in element if child.tag not in elements)
        texts = (element.text, *(child.tail for child in element))
        unknown += ((text.strip(), ()) for text in texts if text and text.strip())
        for name, known in unknown:
            # Whether it could say where something is or what it weighs; no name of a namespace and no label does.
            harmless = ":" in name or "{" in name or name in ("name", "id", "comment") or (tag, name) == PASSED
            meant = WORDS.search(name.lower()) or difflib.get_close_matches(name.lower(), SHAPING, 1, 0.8)
            if not harmless and (tag in SHAPING or (tag in ("robot", "link", "joint") and known and meant)):
                remedy = near_miss(name, known) or "correct it, or leave it out where it changes nothing"
                found, allowed = f"{tag}: {quoted(name)} is not known, and could change the arm", ", ".join(known)
                raise self.refused(element, found, remedy, allowed and f"allowed: {allowed}")
            self.unread[quoted(name)[1:-1] + ("" if known is elements else f" of {tag}")] += 1
        within = Counter(child.tag for child in element)
        for child in () if tag == "robot" else [child for child in elements if child in within]:
            if within[child] > 1:
                self.note(element, f"{within[child]} elements {child} in one {tag}: the first is taken")
            self.look(element.find(child))
