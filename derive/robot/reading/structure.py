"""How the structure of a file is declared, and whether a file has it; pydantic is for JSON Schemas and refusals alone.

Most files are right, and pydantic takes longer to import than such a file to check. So what a class says of its keys
is looked at here, and its model of pydantic's is made when somebody asks for it.
"""

from __future__ import annotations

from enum import EnumType
from functools import partial, reduce
from operator import or_
from types import UnionType, new_class
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

if TYPE_CHECKING:
    from pydantic import BaseModel


class Strict:
    """A block of a file: its keys are annotated, and any key that is not named is an error."""

    def __init_subclass__(cls, options: Any = None) -> None:
        """Keys that may be left out: the fields of a dataclass of options, each annotated with what it is."""
        for name, kind in get_type_hints(options, include_extras=True).items() if options else ():
            cls.__annotations__[name] = kind.__origin__ | None
            setattr(cls, name, usually(None, kind.__metadata__[0]))


class _Said:
    """What is said of a key or a type in pydantic's words: the class of pydantic's, and its arguments."""

    def __init__(self, name: str, *arguments: Any, **options: Any) -> None:
        self.name, self.arguments, self.options = name, arguments, options


Field: Any = partial(_Said, "Field")
Tag: Any = partial(_Said, "Tag")
Discriminator: Any = partial(_Said, "Discriminator")
WithJsonSchema: Any = partial(_Said, "WithJsonSchema")


def usually(value: Any, description: str, **options: Any) -> Any:
    """A key that may be left out, which then has a value, or is nothing for None."""
    return Field(default=value, description=description, **options)


_read: dict[type[Strict], dict[str, tuple[Any, bool]]] = {}
_models: dict[type[Strict], Any] = {}


def _keys(block: type[Strict]) -> dict[str, tuple[Any, bool]]:
    """The type of each key, and whether it must be there."""
    if block in _read:
        return _read[block]
    found = _read[block] = {}
    for name, kind in get_type_hints(block, include_extras=True).items():
        said = getattr(block, name)
        found[name] = kind, isinstance(said, _Said) and "default" not in said.options
    return found


def fits(kind: Any, value: Any) -> bool:
    """Whether texts, lists and dicts have the structure of a type."""
    origin, of = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return fits(of[0], value)
    if origin in (Union, UnionType):
        return any(fits(choice, value) for choice in of if choice is not type(None))
    if origin is Literal:
        return isinstance(value, str) and value in of
    if origin is dict:
        return isinstance(value, dict) and all(fits(of[1], item) for item in value.values())
    if origin is list:
        return isinstance(value, list) and all(fits(of[0], item) for item in value)
    if origin is tuple:
        return isinstance(value, list) and len(value) == len(of) and all(map(fits, of, value))
    if isinstance(kind, EnumType):
        return isinstance(value, str) and value in list(map(str, kind))
    if isinstance(kind, type) and issubclass(kind, Strict):
        keys = _keys(kind)
        return (
            isinstance(value, dict)
            and value.keys() <= keys.keys()
            and all(name in value for name, (_, is_needed) in keys.items() if is_needed)
            and all(fits(keys[name][0], item) for name, item in value.items())
        )
    return kind is str and isinstance(value, str)


def model_of(block: type[Strict]) -> type[BaseModel]:
    """The model of pydantic's, which says what is wrong, and where."""
    if block not in _models:
        import pydantic

        body: dict[str, Any] = {"__doc__": block.__doc__, "__module__": block.__module__, "__annotations__": {}}
        body["model_config"] = pydantic.ConfigDict(frozen=True, extra="forbid", strict=False)
        for name, (kind, _) in _keys(block).items():
            body["__annotations__"][name], body[name] = _in_pydantic(kind), _in_pydantic(getattr(block, name))
        _models[block] = new_class(block.__name__, (pydantic.BaseModel,), exec_body=lambda space: space.update(body))
    found: type[BaseModel] = _models[block]
    return found


def _in_pydantic(what: Any) -> Any:
    """A type, a default or what is said of a key, with the models of pydantic's in it."""
    import pydantic

    origin, of = get_origin(what), get_args(what)
    if isinstance(what, _Said):
        options = {name: _in_pydantic(value) for name, value in what.options.items()}
        return getattr(pydantic, what.name)(*what.arguments, **options)
    if isinstance(what, Strict):
        return model_of(type(what))()
    if isinstance(what, type) and not of and issubclass(what, Strict):
        return model_of(what)
    if origin is Annotated:
        return Annotated[tuple(map(_in_pydantic, (of[0], *what.__metadata__)))]
    if origin in (Union, UnionType):
        return reduce(or_, map(_in_pydantic, of))
    return origin[tuple(map(_in_pydantic, of))] if origin in (list, tuple, dict) else what


def schema_of(block: type[Strict]) -> dict[str, Any]:
    """The JSON Schema of a block, for editors."""
    found: dict[str, Any] = _without_null(model_of(block).model_json_schema(ref_template="#/$defs/{model}"))
    return found


def _without_null(schema: Any) -> Any:
    """Keys that may be left out may not be null: in a robot file ``null`` is a text like any other."""
    if isinstance(schema, list):
        return [_without_null(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    plain = {key: _without_null(value) for key, value in schema.items() if not (key == "default" and value is None)}
    options = [option for option in plain.get("anyOf", []) if option != {"type": "null"}]
    if len(options) == 1:
        del plain["anyOf"]
        plain = {**options[0], **plain}
    return plain
