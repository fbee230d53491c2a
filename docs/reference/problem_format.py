#!/usr/bin/env python3
"""Writes problem_format.md from problems/problem.schema.json; with --check only says whether it is up to date."""

import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
SCHEMA = json.loads((HERE.parent.parent / "problems" / "problem.schema.json").read_text())
DEFINITIONS = SCHEMA["definitions"]
SIGNS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
# Definitions that a table cell says in a word.
WORDS = {"shell_surface": "`\"both\"`, `\"bottom\"`, `\"top\"`, `\"mid\"`", "vector": "[x, y, z]", "body_name": "name of a body", "name": "string"}

INTRODUCTION = """# Problem format

<!-- Written by problem_format.py from problems/problem.schema.json: edit those. -->

A problem is one JSON file; `taut schema` prints its JSON Schema, from which this page is made. `//` and `/* */` comments are allowed.
Units are SI. Keys that are not listed here, keys that occur twice and numbers out of range are refused with one line that says where,
what was found and what is allowed.

The smallest problem, a square that hangs by a corner:

```json
{
  "format": 1,
  "time": { "integrator": "implicit_euler", "step": 0.01, "steps": 50 },
  "gravity": [0, 0, -9.81],
  "bodies": {
    "cloth": {
      "mesh": { "grid": { "size": [1, 1], "cells": [16, 16] } },
      "thickness": 0.0003, "density": 500,
      "membrane": { "law": "stvk", "young_modulus": 8000, "poisson_ratio": 0.25 }
    }
  },
  "constraints": { "corner": { "type": "pin", "body": "cloth", "select": { "corners": ["x0y1"] } } }
}
```

`--set KEY=VALUE` replaces one value, with a dotted key: `--set constraints.limit.max=1.05`. The value is JSON, or else taken as a string;
`null` takes the key out, as if the file did not have it. The section that holds the key has to be in the file or have a default.

A run's identity is a hash of the completed problem and of the bytes of its mesh files; `output`, `name`, `description` and `look_for` are left
out, and key order, comments and paths do not matter.

"""


def anchor(name):
    return name.replace("_", "-")


def title(name):
    return name.replace("_", " ").capitalize()


def allowed(schema):
    """What a key may hold, in a table cell."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        return WORDS.get(name) or f"[{name.replace('_', ' ')}](#{anchor(name)})"
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    if schema["type"] == "array":
        count = str(schema["minItems"]) if schema.get("minItems") == schema.get("maxItems", -1) else ""
        return f"list of {count + ' ' if count else ''}{allowed(schema['items'])}"
    if schema["type"] == "object" and isinstance(schema.get("additionalProperties"), dict):
        return f"name: {allowed(schema['additionalProperties'])}"
    if schema["type"] == "object":
        return "object: " + ", ".join(f"`{key}`: {allowed(value)}" for key, value in schema["properties"].items())
    bounds = " and ".join(f"{sign} {schema[key]}" for key, sign in SIGNS.items() if key in schema)
    return f"{schema['type']} {bounds}".strip()


def rows(schema):
    for key, value in schema["properties"].items():
        unit = "" if value["unit"] in ("-", "1") else value["unit"]
        if key in schema.get("required", []):
            default = "*required*"
        else:
            default = f"`{json.dumps(value['default'])}`" if "default" in value else "absent"
        cells = [f"`{key}`", allowed(value), unit, default, value["description"]]
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def table(schema):
    head = ["| key | value | unit | default | |", "|---|---|---|---|---|"]
    return "\n".join(head + list(rows(schema))) + "\n"


def section(name, schema):
    text = f"## {title(name)} {{#{anchor(name)}}}\n\n{schema['description']}\n\n"
    if "properties" in schema:
        return text + table(schema)
    branches = schema["oneOf"]
    if all("$ref" in branch for branch in branches):
        return text + "".join(f"- {allowed(branch)}\n" for branch in branches)
    merged = {key: value for branch in branches for key, value in branch["properties"].items()}
    return text + "Exactly one of:\n\n" + table({"properties": merged}).replace("| absent |", "| |")


def page():
    parts = [INTRODUCTION + "## The file\n\n" + table(SCHEMA)]
    parts += [section(name, schema) for name, schema in DEFINITIONS.items() if name not in WORDS]
    return "\n".join(parts)


if __name__ == "__main__":
    sys.stdout.write(page())
