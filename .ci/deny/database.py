#!/usr/bin/env python3
"""Writes a database of advisories as cargo-deny reads it, from a file of rows: database.py advisories.toml FOLDER.

Fails where a crate of a lock file was never looked up, since nothing is known of it then.
"""
import json
import pathlib
import sys
import tomllib

from rows import locked


def main():
    source, folder = map(pathlib.Path, sys.argv[1:])
    rows = tomllib.loads(source.read_text())
    unknown = [name for name in locked(pathlib.Path(__file__).resolve().parents[2]) if name not in rows["names"]]
    if unknown:
        sys.exit(
            f"{source} does not know {', '.join(unknown)}. Renew the file with .ci/deny/rows.py, or look each crate up at "
            "https://rustsec.org/advisories and add its name and a row for each of its advisories."
        )
    for row in rows["advisory"]:
        kind = [] if row["kind"] == "vulnerability" else [f"informational = {json.dumps(row['kind'])}"]
        lines = [
            "```toml",
            "[advisory]",
            f"id = {json.dumps(row['id'])}",
            f"package = {json.dumps(row['crate'])}",
            f"date = {json.dumps(row['date'])}",
            f"url = {json.dumps('https://rustsec.org/advisories/' + row['id'])}",
            *kind,
            "[versions]",
            f"patched = {json.dumps(row['patched'])}",
            f"unaffected = {json.dumps(row['unaffected'])}",
            "```",
            "",
            f"# {row['id']}",
            "",
            f"https://rustsec.org/advisories/{row['id']}",
            "",
        ]
        path = folder / "crates" / row["crate"] / f"{row['id']}.md"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines))
    print(f"advisories: {len(rows['advisory'])} in {len(rows['names'])} crates that were looked up, state {rows['state']}")


if __name__ == "__main__":
    main()
