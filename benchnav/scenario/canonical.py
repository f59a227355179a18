"""The canonical form of a specification, from which its hash is computed.

The form is frozen: it has the key names of version 0.1.0, and all keys that 0.1.0 had. A key
that was added later is left out while it has its default, and a key that was renamed later has
its old name. Adding or renaming a key therefore changes no hash of an existing scenario.
"""

from typing import Any

from pydantic import BaseModel, Field

ADDED, OLD_NAME = "added_in", "name_in_0_1"  # in the JSON schema of a field


def added_field(default: Any, version: str, **options: Any) -> Any:
    """Return a pydantic field that was added in ``version``, after 0.1.0."""
    return Field(default, json_schema_extra={ADDED: version}, **options)


def renamed_field(old_name: str, *default: Any, **options: Any) -> Any:
    """Return a pydantic field that was called ``old_name`` in 0.1.0."""
    return Field(*default, json_schema_extra={OLD_NAME: old_name}, **options)


def canonical(model: BaseModel, exclude: set[str] | None = None) -> dict[str, Any]:
    """Return the canonical form of a specification, of types that JSON has.

    ``exclude`` names keys of ``model`` itself that are left out.
    """
    form: dict[str, Any] = _canonical(model, model.model_dump(mode="json", exclude=exclude))
    return form


def _canonical(value: Any, dumped: Any) -> Any:
    """Return ``dumped``, the JSON form of ``value``, with keys named and left out as above."""
    if isinstance(value, BaseModel) and isinstance(dumped, dict):
        return dict(_members(value, dumped))
    if isinstance(value, dict):
        pairs = zip(value.values(), dumped.items(), strict=True)
        return {key: _canonical(member, form) for member, (key, form) in pairs}
    if isinstance(value, list | tuple):
        return [_canonical(*pair) for pair in zip(value, dumped, strict=True)]
    return dumped


def _members(model: BaseModel, dumped: dict[str, Any]) -> Any:
    for name, form in dumped.items():
        field, value = type(model).model_fields.get(name), getattr(model, name, form)
        if field is None:  # a parameter of a plugin
            yield name, form
            continue
        extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        if ADDED in extra and value == field.get_default(call_default_factory=True):
            continue
        yield str(extra.get(OLD_NAME, name)), _canonical(value, form)
