"""JSON Schemas whose properties are described by the docstrings below the models' fields."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core.core_schema import ModelSchema


class DescribedSchema(GenerateJsonSchema):
    """Pydantic's generator, with descriptions.

    Its own `use_attribute_docstrings` reads the source of every model when that is imported, which would cost each
    command a tenth of a second for the sake of this one.
    """

    def model_schema(self, schema: ModelSchema) -> JsonSchemaValue:
        """The JSON Schema of one model, each property with the docstring below its field."""
        described, model = super().model_schema(schema), schema["cls"]
        texts = _docstrings(model.__module__).get(model.__name__, {})
        names = {field.alias or name: name for name, field in model.model_fields.items()}
        for key, value in described.get("properties", {}).items():
            if names[key] in texts:
                value["description"] = texts[names[key]]
        return described


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
