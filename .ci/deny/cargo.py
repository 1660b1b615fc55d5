#!/usr/bin/env python3
"""Stands in the place of cargo for cargo-deny 0.14.2, which is of 2023, and writes two things as they were known then.

Since version 1.77 `cargo metadata` names a package `registry+URL#NAME@VERSION`; cargo-deny 0.14.2 expects `NAME VERSION
(registry+URL)`. Its list of licences does not have Unicode-3.0, so that becomes LicenseRef-Unicode-3.0.
"""
import json
import re
import subprocess
import sys


def renamed(value, names):
    """The value with all names of packages replaced."""
    if isinstance(value, dict):
        return {key: renamed(item, names) for key, item in value.items()}
    if isinstance(value, list):
        return [renamed(item, names) for item in value]
    return names.get(value, value) if isinstance(value, str) else value


run = subprocess.run(["cargo", *sys.argv[1:]], stdout=subprocess.PIPE, text=True)
if run.returncode != 0 or "metadata" not in sys.argv:
    print(run.stdout, end="")
    sys.exit(run.returncode)
metadata = json.loads(run.stdout)
names = {}
for package in metadata["packages"]:
    source = package["source"] or package["id"].split("#")[0]
    package["license"] = re.sub(r"\bUnicode-3\.0\b", "LicenseRef-Unicode-3.0", package["license"] or "") or None
    names[package["id"]] = f"{package['name']} {package['version']} ({source})"
print(json.dumps(renamed(metadata, names)))
