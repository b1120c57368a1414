"""How quantities are asked for: ``T[1,4]``, ``A[2]``, ``christoffel[1,1,2]``, and the names that books have for them.

Books write ``M`` or ``mass matrix``, ``V``, ``T06`` or ``^0T_6``, ``det(J)``, ``b_11``. Those that mean one thing are
understood, the others are answered with what may be meant.
"""

import difflib
import re

from derive.errors import QuantityError, listed, quoted
from derive.lecture.sympy_conversion import Expr
from derive.model.dynamic_model import DynamicModel
from derive.model.ends import OfEnds
from derive.model.quantities import OF_ENDS, OF_LOOPS, REGISTRY, Quantity
from derive.robot.tree import end_named

_ASKED = re.compile(r"\s*([^\[\]]*?)\s*(?:\[([^\]]*)\])?\s*(?:\[([^\]]*)\])?\s*")


def evaluate(model: DynamicModel, text: str) -> Expr:
    """A quantity, or an entry of it, by name.

    ``T[2]`` is frame 2; ``T[1,4]`` is the entry in row 1, column 4 where j = 4 is no frame of this robot, and frame 4
    in frame 1 where it is: an entry is always meant by a second bracket, ``T[][1,4]`` or ``T[0,2][1,4]``.
    """
    end, (quantity, indices, entry) = _end_and_rest(model, text)[0], parse(model, text)
    value = quantity.value(model, *indices)
    if end:
        if not isinstance(value, OfEnds):
            what = f"{quantity.name} of an end of {model.robot.name}, which is of the whole tree"
            raise QuantityError(what, remedy=f"leave '{end}' out")
        value = value[end]
    if entry is None:
        return value
    return value.each(lambda one: pick(one, entry, text)) if isinstance(value, OfEnds) else pick(value, entry, text)


def _end_and_rest(model: DynamicModel, text: str) -> tuple[str, str]:
    """The end of a tree that a name asks for, empty for none, and the name without it: ``T[left][1,4]``."""
    match = re.fullmatch(r"\s*([^\[\]]*?)\s*\[\s*(\w+)\s*(?:,([^\]]*))?\](.*)", text)
    ends = [end.name for end in model.robot.ends if end.name]
    if match and ends and match[1] in OF_ENDS - {"T"} and not match[2].isdigit():
        end_named(model.robot, match[2])  # which refuses others
    if match is None or match[2] not in ends:
        return "", text
    rest = (f"[{match[3]}]" if match[3] else "") + match[4]
    return match[2], match[1] + ("[]" if match[1] == "T" and rest else "") + rest


def by_ends(model: DynamicModel, text: str) -> list[str]:
    """A name, or where it asks for a quantity of all ends of a tree, one for each end: ``T[left]``, ``T[right]``."""
    names = [end.name for end in model.robot.ends if end.name]
    quantity, indices, _ = parse(model, text)
    of_ends = quantity.name in OF_ENDS and not (quantity.name == "T" and indices)
    if not (names and of_ends) or _end_and_rest(model, text)[0]:
        return [text]
    word, bracket, rest = re.sub(r"\[\s*\]", "", text, count=1).partition("[")
    return [f"{word.strip()}[{name}]{bracket}{rest}" for name in names]


def of_one_end(model: DynamicModel, text: str) -> str:
    """A name with that of the only end, where it asks for a quantity of ends; one of several is to be named."""
    if len(named := by_ends(model, text)) > 1:
        found = f"{quoted(text)} of {model.robot.name}, which has several ends"
        raise QuantityError(found, allowed=f"allowed: {listed(named)}")
    return named[0]


def parse(model: DynamicModel, text: str) -> tuple[Quantity, tuple[int, ...], tuple[int, ...] | None]:
    """What a name with indices asks for, the end of a tree left out; T has names of a tree's rows for indices, too."""
    text = _end_and_rest(model, text)[1]
    if (named_frames := _frames(model, text)) is not None:
        return REGISTRY["T"], *named_frames
    written = re.sub(r"\(([\d,\s]+)\)", r"[\1]", re.sub(r"^\s*T\((\d+\s*,\s*\d+)\)", r"T[][\1]", text))
    match = _ASKED.fullmatch(written)
    if match is None or not match[1]:
        found = f"unknown quantity {quoted(text)}"
        raise QuantityError(found, allowed="allowed: a name with indices, such as T, A[2], christoffel[1,1,2]")
    row = _row(model, match[1])
    quantity, named = (row, ()) if row else _spoken(model, match[1])
    brackets = [_integers(indices, text) for indices in match.groups()[1:] if indices is not None]
    if named:  # indices that stand in the name
        brackets.insert(0, named)
    first = brackets[0] if brackets else ()
    if len(brackets) > 1 and len(first) in quantity.indices:
        return quantity, first, tuple(index for bracket in brackets[1:] for index in bracket) or None
    # two indices of T can only be a row and a column where the arm has no such frame
    frames = model.robot.n + len(model.robot.fixed)
    is_entry = quantity.name == "T" and len(first) == 2 and max(first) > frames and not named
    if len(first) in quantity.indices and not is_entry:
        return quantity, first, None
    for count in sorted(quantity.indices if len(brackets) < 2 else ()):
        if len(first) - count in (1, 2):
            return quantity, first[:count], first[count:]
    counts = " or ".join(map(str, quantity.indices))
    found = f"{len(first)} indices in {text!r}"
    raise QuantityError(found, allowed=f"{counts} for {quantity.name}, and an entry behind them")


def _frames(model: DynamicModel, text: str) -> tuple[tuple[int, ...], tuple[int, ...] | None] | None:
    """The frames in ``T[waist]`` and ``T[base,head][1,4]``, and the entry; None where no row of a tree is named."""
    match = re.fullmatch(r"\s*T\s*\[([^\[\]]*)\]\s*(?:\[([^\[\]]*)\])?\s*", text)
    words = [word.strip() for word in match[1].split(",")] if match and model.robot.is_tree else []
    if match is None or len(words) not in (1, 2) or all(word.isdigit() for word in words) or not all(words):
        return None
    frames = tuple(int(word) if word.isdigit() else model.frame_number(word, or_end=len(words) == 1) for word in words)
    return frames, _integers(match[2], text) or None


def _key(word: str) -> str:
    """What counts of a word: letters and digits, in either case where they are several."""
    letters = "".join(character for character in word[:80] if character.isalnum())
    return letters if len(letters) == 1 else letters.casefold()


_WORDS: dict[str, tuple[Quantity, ...]] = {}
for _quantity in REGISTRY.values():
    for _word in _quantity.words:
        _WORDS[_key(_word)] = (*_WORDS.get(_key(_word), ()), _quantity)
_WORDS |= {_key(name): (quantity,) for name, quantity in REGISTRY.items() if len(name) > 1}


def _spoken(model: DynamicModel, word: str) -> tuple[Quantity, tuple[int, ...]]:
    """The quantity that is called otherwise in books, and indices that stand in its name: ``M``, ``T06``, ``b_11``."""
    known = _known(model, _key(word), word)
    if known is not None:
        return known, ()
    bare = re.sub(r"[{}\s]", "", word)
    letters, numbers = re.sub(r"[\W\d_]", "", bare), re.findall(r"\d+", bare)
    if len(numbers) == 1 and model.robot.n < 10:  # b_12
        numbers = list(numbers[0])
    indices = tuple(map(int, numbers[:6]))
    if letters in ("T", "A") and len(indices) == 2:
        i, j = indices
        if above := re.search(r"\^(\d+)", bare):
            i, j = int(above[1]), next((k for k in indices if k != int(above[1])), int(above[1]))
        if above and i > j:
            meanings = f"T[{j},{i}], frame {i} in frame {j}, or T[{i},{j}], its inverse"
            raise QuantityError(f"{quoted(word)} is ambiguous", allowed=f"it can mean {meanings}")
        return (REGISTRY["A"], (j,)) if letters == "A" and j == i + 1 else (REGISTRY["T"], (i, j))
    row = _row(model, letters) or _known(model, _key(letters), letters)
    if row is not None and indices and re.fullmatch(r"[A-Za-z]+[\d\W_]+", bare):
        return row, indices
    if axis := re.fullmatch(r"p_?([xyz])", bare):
        return REGISTRY["p"], ("xyz".index(axis[1]) + 1,)
    keys = difflib.get_close_matches(_key(word), _WORDS, n=3, cutoff=0.72)
    close = [REGISTRY.get(word.swapcase()), *(row for key in keys for row in _WORDS[key])]
    near = dict.fromkeys(row.name for row in close if row is not None and row.is_of(model.robot))
    if near:
        raise QuantityError(f"unknown quantity {quoted(word)}", remedy=f"did you mean {' or '.join(near)}?")
    names = (row.name for row in REGISTRY.values() if row.is_of(model.robot))
    raise QuantityError(f"unknown quantity {quoted(word)}", allowed=f"allowed: {listed(names)}")


def _row(model: DynamicModel, name: str) -> Quantity | None:
    """The row of a name; a letter that only robots with closed loops have means what books call by it elsewhere."""
    return None if name in OF_LOOPS and len(name) == 1 and not model.robot.passive else REGISTRY.get(name)


def _known(model: DynamicModel, key: str, word: str) -> Quantity | None:
    """The one quantity of this robot, or of any, that a word means."""
    rows = _WORDS.get(key, ())
    rows = tuple(row for row in rows if row.is_of(model.robot)) or rows
    if len(rows) > 1:
        meanings = " or ".join(f"{row.name} ({row.summary.partition(';')[0]})" for row in rows)
        raise QuantityError(f"{quoted(word)} has several meanings", remedy=f"did you mean {meanings}?")
    return rows[0] if rows else None


def _integers(text: str | None, whole: str) -> tuple[int, ...]:
    if text is None or not text.strip():
        return ()
    parts = [part.strip() for part in text.split(",")]
    if not all(part.isascii() and part.isdigit() and len(part) < 4 for part in parts):
        found = f"the indices in {whole!r} are not valid"
        raise QuantityError(found, allowed="allowed: whole numbers from 1, separated by commas")
    return tuple(int(part) for part in parts)


def pick(value: Expr, entry: tuple[int, ...], text: str) -> Expr:
    """One entry of a matrix."""
    shape = getattr(value, "shape", None)
    if shape is None:
        raise QuantityError(f"{text!r} asks for an entry of a scalar", remedy="leave the indices out")
    if len(entry) > 2:
        raise QuantityError(f"{len(entry)} indices of an entry in {text!r}", allowed="allowed: a row and a column")
    row, column = (entry[0], 1) if len(entry) == 1 else (entry[0], entry[1])
    if (len(entry) == 1 and shape[1] != 1) or not (1 <= row <= shape[0] and 1 <= column <= shape[1]):
        found = f"entry {list(entry)} of {text!r} is out of range"
        raise QuantityError(found, allowed=f"allowed: rows 1 to {shape[0]}, columns 1 to {shape[1]}")
    return value[row - 1, column - 1]
