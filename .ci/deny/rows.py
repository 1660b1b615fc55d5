#!/usr/bin/env python3
"""Writes the rows of `advisories.toml` for all crates of the lock files, from a clone of the RustSec database:

    git clone https://github.com/rustsec/advisory-db /tmp/advisory-db
    .ci/deny/rows.py /tmp/advisory-db > /tmp/rows && mv /tmp/rows .ci/deny/advisories.toml

It reads what is committed there, so a bare clone serves as well. Advisories that were withdrawn have no row.
"""
import json
import pathlib
import re
import subprocess
import sys
import tomllib

HEAD = """\
# Facts of the RustSec advisory database, https://github.com/rustsec/advisory-db, for the crates of Cargo.lock and
# fuzz/Cargo.lock. `.ci/deny/run` judges by them where the network does not give the database itself.
# `.ci/deny/rows.py` writes this file.
"""


def locked(root):
    """Names of all crates from a registry in the lock files, sorted."""
    names = set()
    for lock in ("Cargo.lock", "fuzz/Cargo.lock"):
        packages = tomllib.loads((root / lock).read_text())["package"]
        names |= {package["name"] for package in packages if "source" in package}
    return sorted(names)


def main():
    clone = sys.argv[1]

    def git(*words):
        return subprocess.run(["git", "-C", clone, *words], check=True, capture_output=True, text=True).stdout

    names = locked(pathlib.Path(__file__).resolve().parents[2])
    state = git("log", "-1", "--format=%H of %cs").strip()
    print(HEAD + f"state = {json.dumps(state)}\n\n# Crates that were looked up.\nnames = [")
    for name in names:
        print(f"    {json.dumps(name)},")
    print("]")
    looked_up = set(names)
    for path in git("ls-tree", "-r", "--name-only", "HEAD", "crates/").splitlines():
        if path.split("/")[1] not in looked_up or not path.endswith(".md"):
            continue
        front = re.match(r"```toml\n(.*?)\n```", git("show", f"HEAD:{path}"), re.DOTALL)
        facts = tomllib.loads(front[1])
        advisory = facts["advisory"]
        if "withdrawn" in advisory:
            continue
        row = {
            "id": advisory["id"],
            "crate": advisory["package"],
            "date": str(advisory["date"]),
            "kind": advisory.get("informational", "vulnerability"),
            "patched": facts["versions"].get("patched", []),
            "unaffected": facts["versions"].get("unaffected", []),
        }
        print("\n[[advisory]]")
        for key, value in row.items():
            print(f"{key} = {json.dumps(value)}")


if __name__ == "__main__":
    main()
