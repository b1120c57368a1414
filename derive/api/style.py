"""The style of a book from some of its formulas, from Python: which options write them as they are printed."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Self

from derive.api.robots import RobotLike, load
from derive.checking.comparison import check_file
from derive.checking.documents import read_document
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.findings import Outcome
from derive.checking.latex.check import check_latex
from derive.checking.style_finding import Example, ExampleVerdict, StyleEvidence, printed_examples
from derive.errors import CheckError, Location, quoted
from derive.lecture.shorthand import read_formula
from derive.model.model import Model
from derive.robot.load import file_bytes
from derive.robot.options.style import DEFAULT_STYLE, NAMED_STYLES
from derive.robot.options.style import Style as Options
from derive.robot.reading.document import YamlMapping, read_tree
from derive.robot.robot import Robot

_LATEX = re.compile(r"[\\^{}_]")
EXAMPLE = "--example"
"""Where an example stands that was given in words, for messages."""


@dataclass(frozen=True, slots=True)
class FoundStyle:
    """The style that reproduces most of some printed formulas; as text, what ``derive style`` prints.

    Attributes:
        style: The style.
        verdicts: One for each formula that contains a sum, in their order; the others have one form only.
        default: How many of them the default style reproduces.
    """

    style: Options
    verdicts: tuple[ExampleVerdict, ...]
    default: int

    @property
    def reproduced(self) -> int:
        """How many formulas come out as printed."""
        return sum(verdict.reproduced for verdict in self.verdicts)

    @property
    def passed(self) -> bool:
        """Whether every formula is right."""
        return all(verdict.outcome != Outcome.WRONG.value for verdict in self.verdicts)

    @property
    def block(self) -> str:
        """The block ``style:`` of a robot file, as YAML."""
        options = self.style.options() or {"name": DEFAULT_STYLE}
        if list(options) == ["name"]:
            return f"style: {options['name']}"
        return "\n".join(["style:", *(f"  {name}: {value}" for name, value in options.items())])

    def as_dict(self) -> dict[str, object]:
        """Plain data, for JSON."""
        return {
            "style": self.style.options() or {"name": DEFAULT_STYLE},
            "reproduced": self.reproduced,
            "default": self.default,
            "examples": [asdict(verdict) for verdict in self.verdicts],
        }

    def __str__(self) -> str:
        lines = [self.summary]
        for verdict in self.verdicts:
            if not verdict.reproduced:
                lines.append(f"{verdict.place}: {verdict.quantity}: {verdict.reason}")
                lines += [f"  printed: {verdict.printed}", f"  written: {verdict.written}"]
        return "\n".join([self.block, *(f"# {line}" for line in lines)])

    @property
    def summary(self) -> str:
        """How many formulas come out as printed, in words."""
        total = len(self.verdicts)
        formulas = "formula" if total == 1 else "formulas"
        return f"as printed: {self.reproduced} of {total} {formulas}, {self.default} in the default style"


class Style(Options):
    """How a book writes its expressions: a few independent options; see `derive.robot.options.style.Style`.

    `from_examples` finds the options from formulas as the book prints them.
    """

    @classmethod
    def from_examples(cls, robot: RobotLike, examples: Iterable[str | Path] | Mapping[str, str] = ()) -> Self:
        """The style in which most of some printed formulas come out as they are printed.

        Args:
            robot: A robot, the path of a robot file or of a corpus file, or a name of the catalogue.
            examples: See `find_style`.

        Returns:
            The style, for ``Model(robot, style=...)``.

        Raises:
            CheckError: A formula cannot be read, or there is none.
            QuantityError: A formula of no quantity of the robot.
        """
        found = find_style(robot, examples=examples).style
        return cls(**{option.name: getattr(found, option.name) for option in fields(found)})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Options) and self.options() == other.options()

    def __hash__(self) -> int:
        return hash(tuple(self.options().items()))


def find_style(*sources: RobotLike, examples: Iterable[str | Path] | Mapping[str, str] = ()) -> FoundStyle:
    """The style that reproduces most of some printed formulas, as ``derive style`` finds it.

    Args:
        sources: Corpus files with a robot and its printed formulas, of one book; or one robot, or the path of its file,
            or its name in the catalogue, with ``examples``.
        examples: Formulas of the one robot: texts such as ``tau[1] = m*l**2*qdd1``, also in LaTeX; or formulas by
            quantity, ``{"tau[1]": "m*l**2*qdd1"}``; or a `Path` of a corpus file, or of a LaTeX document on the robot.

    Returns:
        The style, and what it makes of each formula.

    Raises:
        RobotFileError: A file cannot be read or does not describe a robot.
        CheckError: A formula cannot be read, or there is none that tells anything.
        QuantityError: A formula of no quantity of its robot.
    """
    found = [example for source in sources for example in _printed_in(source)]
    given = [f"{name} = {text}" for name, text in examples.items()] if isinstance(examples, Mapping) else examples
    for example in given:
        if isinstance(example, Path) and example.suffix != ".tex":
            found += _printed_in(example)
        elif len(sources) == 1:
            found += _given(load(sources[0], remarks_on_bodies=False), example)
        else:
            shown = example.name if isinstance(example, Path) else example
            raise CheckError(f"example {quoted(shown)} of {len(sources)} robots", allowed="allowed: one robot")
    if not found:
        raise CheckError(
            "no printed formula with a sum",
            allowed="formulas that can be written in more than one way tell the style",
            remedy=f"give a corpus file, or {EXAMPLE} 'tau[1] = ...'",
        )
    evidence = StyleEvidence(found)
    chosen = evidence.best_style()
    return FoundStyle(chosen, tuple(evidence.verdicts(chosen)), evidence.reproduced(NAMED_STYLES[DEFAULT_STYLE]))


def _printed_in(source: RobotLike) -> list[Example]:
    """The printed formulas of a corpus file; none where a robot is given, or a file or name of one."""
    load(source, remarks_on_bodies=False)  # which refuses what is neither
    if isinstance(source, Robot) or not Path(source).is_file():
        return []
    name, data = str(source), file_bytes(Path(source))
    root = read_tree(data, name)
    if not isinstance(root, YamlMapping) or "expected" not in root.entries:
        return []
    return printed_examples(check_file(corpus_from_bytes(data, name)).findings)


def _given(robot: Robot, example: str | Path) -> list[Example]:
    """``tau[1] = ...``, equations in LaTeX, or those of a LaTeX file."""
    if isinstance(example, Path) or _LATEX.search(example):
        of_file = isinstance(example, Path)
        text, start = (read_document(str(example)).text, str(example)) if of_file else (str(example), EXAMPLE)
        findings = check_latex(Model(robot), text, start=Location(start), document=of_file).findings
        unknown = next((finding.unknown for finding in findings if finding.unknown is not None), None)
        if unknown is not None and not of_file:
            raise unknown
        return printed_examples(findings)
    left, equals, right = example.partition("=")
    quantity, printed = left.strip(), right.strip()
    if not quantity or not printed:
        allowed = "allowed: a scalar quantity and what is printed for it, such as 'tau[1] = m*l**2*qdd1'"
        raise CheckError(f"example {quoted(example)}", allowed=allowed, location=Location(EXAMPLE))
    place = Location(EXAMPLE, 1, len(left + equals) + len(right) - len(right.lstrip()) + 1)
    return [Example(robot, quantity, read_formula(printed, robot, place), printed, place)]
