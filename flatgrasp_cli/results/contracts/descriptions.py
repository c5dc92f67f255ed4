"""JSON Schemas whose properties are described by the docstrings below the fields of models and typed dictionaries."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
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


def _described(schema: JsonSchemaValue, of: type) -> JsonSchemaValue:
    texts = _docstrings(of.__module__).get(of.__name__, {})
    for key, value in schema.get("properties", {}).items():
        if key in texts:
            value["description"] = texts[key]
    return schema


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
