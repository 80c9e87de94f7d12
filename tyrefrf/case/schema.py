"""The JSON schema of case files, by which editors and tombi complete and check them."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from tyrefrf.case.model import Case


class _TomlSchema(GenerateJsonSchema):
    """A schema without null, which TOML has not, and without titles that repeat the keys."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        if schema.get("default", ...) is None:
            return self.generate_inner(schema["schema"])
        return super().default_schema(schema)

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False


def case_schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of a case file."""
    schema = Case.model_json_schema(schema_generator=_TomlSchema)
    schema["required"].remove("name")  # the file's name serves
    return {"$schema": GenerateJsonSchema.schema_dialect, **schema, "title": "A tyrefrf case"}
