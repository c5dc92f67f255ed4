"""JSON Schemas whose properties are described by the docstrings below the fields of models and typed dictionaries."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from typing import Any

from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaMode, JsonSchemaValue
from pydantic_core.core_schema import ModelSchema, TypedDictSchema


class DescribedSchema(GenerateJsonSchema):
    """Pydantic's generator, with descriptions.

    Its own `use_attribute_docstrings` reads the source of every model when that is imported, which would cost each
    command a tenth of a second for the sake of this one.
    """

    def model_schema(self, schema: ModelSchema) -> JsonSchemaValue:
        """The JSON Schema of one model, each property with the docstring below its field."""
        return _described(super().model_schema(schema), schema["cls"])

    def typed_dict_schema(self, schema: TypedDictSchema) -> JsonSchemaValue:
        """That of one typed dictionary, which has no other keys."""
        return _described(super().typed_dict_schema(schema), schema["cls"]) | {"additionalProperties": False}


def described(of: type, mode: JsonSchemaMode) -> dict[str, Any]:
    """The JSON Schema of what is written as this type (`serialization`) or taken for it (`validation`), described."""
    return TypeAdapter(of).json_schema(by_alias=True, mode=mode, schema_generator=DescribedSchema)


def extendable(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema of a profile that may leave keys to the shipped one that it `extends`: then none is required."""
    from flatgrasp_cli.profiles import list_profiles

    parts = {
        name: {key: value for key, value in part.items() if key != "required"} for name, part in schema["$defs"].items()
    }
    extends = {
        "type": "string",
        "enum": list_profiles("planner"),
        "description": "The shipped profile that has the keys which are left out.",
    }
    whole = {key: value for key, value in schema.items() if key != "required"}
    return {**whole, "$defs": parts, "properties": {"extends": extends, **schema["properties"]}}


def _described(schema: JsonSchemaValue, of: type) -> JsonSchemaValue:
    texts = _texts(of)
    for key, value in schema.get("properties", {}).items():
        if key in texts:
            value["description"] = texts[key]
    return schema


def _texts(of: type) -> dict[str, str]:
    """The docstrings of a type's fields, by field, with those that it inherits."""
    texts: dict[str, str] = {}
    for base in getattr(of, "__orig_bases__", of.__bases__):  # a typed dictionary's own say nothing but dict
        if isinstance(base, type) and base.__module__.partition(".")[0] == __name__.partition(".")[0]:
            texts |= _texts(base)
    return texts | _docstrings(of.__module__).get(of.__name__, {})


@lru_cache
def _docstrings(module: str) -> dict[str, dict[str, str]]:
    """The docstrings of a module's classes' fields, by class and field, each in one line."""
    tree = ast.parse(inspect.getsource(sys.modules[module]))
    return {node.name: dict(_of_fields(node)) for node in tree.body if isinstance(node, ast.ClassDef)}


def _of_fields(definition: ast.ClassDef) -> Iterator[tuple[str, str]]:
    for field, below in pairwise(definition.body):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and isinstance(below, ast.Expr):
            text = ast.literal_eval(below.value)
            yield field.target.id, " ".join(text.split())
