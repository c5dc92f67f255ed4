"""JSON Schemas whose properties are described by the docstrings below the models' fields."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaMode, JsonSchemaValue
from pydantic_core.core_schema import ModelSchema


class DescribedSchema(GenerateJsonSchema):
    """Pydantic's generator, with descriptions.

    Its own `use_attribute_docstrings` reads the source of every model when that is imported, which would cost each
    command a tenth of a second for the sake of this one.
    """

    def model_schema(self, schema: ModelSchema) -> JsonSchemaValue:
        """The JSON Schema of one model, each property with the docstring below its field."""
        described, model = super().model_schema(schema), schema["cls"]
        texts: dict[str, str] = {}
        for base in reversed(model.__mro__):
            if issubclass(base, BaseModel) and base is not BaseModel:
                texts |= _docstrings(base.__module__).get(base.__name__, {})
        names = {field.alias or name: name for name, field in model.model_fields.items()}
        for key, value in described.get("properties", {}).items():
            if names[key] in texts:
                value["description"] = texts[names[key]]
        return described


def described(model: type[BaseModel], mode: JsonSchemaMode) -> dict[str, Any]:
    """The JSON Schema of what a model writes (`serialization`) or takes (`validation`), with descriptions."""
    return model.model_json_schema(by_alias=True, mode=mode, schema_generator=DescribedSchema)


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
