"""Reads JSON files as dataclasses, and checks every value: a file may have been edited, cut or swapped."""

import dataclasses
import json
import typing
from typing import Any

from .files import open_regular

NUMBER_LIMIT = 2**63  # Numbers from here on are refused: no sample number, count or duration is that large.


class InvalidFileError(Exception):
    """The text says which value is wrong and how."""


def read_json(path):
    """The content of a JSON file."""
    try:
        with open_regular(path) as file:
            return json.loads(file.read())
    except OSError as error:
        raise InvalidFileError(error.strerror) from error
    except (ValueError, RecursionError) as error:
        raise InvalidFileError(error) from error


def decode(kind, value, place="", lowest=0):
    """`value` of a JSON file as the type `kind`: a dataclass, list, dict, Optional or plain type. Numbers are at least
    `lowest`. `place` is the name of the value in messages."""
    if dataclasses.is_dataclass(kind):
        return _decode_record(kind, value, place, lowest)
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Union:  # Optional
        return None if value is None else decode(arguments[0], value, place, lowest)
    if origin is list and isinstance(value, list):
        return [decode(arguments[0], item, f"{place}[{index}]", lowest) for index, item in enumerate(value)]
    if origin is dict and isinstance(value, dict):
        return {key: decode(arguments[1], item, f"{place}[{key!r}]", lowest) for key, item in value.items()}
    if kind in (int, float):
        accepted = (int,) if kind is int else (int, float)
        if type(value) not in accepted or not lowest <= value < NUMBER_LIMIT:  # NaN fails the comparison.
            raise InvalidFileError(f"{place} is not {'a whole' if kind is int else 'a finite'} number >= {lowest}")
        return kind(value)
    if kind is str and isinstance(value, str) and "\0" in value:
        raise InvalidFileError(f"{place} holds a zero, which no path and no option can hold")
    if kind is Any or type(value) is kind:
        return value
    raise InvalidFileError(f"{place} is not of the type {(origin or kind).__name__}")


def _decode_record(kind, value, place, lowest):
    where = place or "the file"
    if not isinstance(value, dict):
        raise InvalidFileError(f"{where} is not an object")
    kinds = typing.get_type_hints(kind)
    for name in kinds.keys() - value.keys():
        raise InvalidFileError(f"{where} has no {name}")
    for name in value.keys() - kinds.keys():
        raise InvalidFileError(f"{where} has an unknown key {name!r}")
    prefix = f"{place}." if place else ""
    return kind(**{name: decode(kinds[name], value[name], prefix + name, lowest) for name in kinds})
