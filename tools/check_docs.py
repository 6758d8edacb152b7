#!/usr/bin/python3
"""Fails where a relative link in README.md, CONTRIBUTING.md or docs/ leads nowhere."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("**/*.md"))]
broken = []
for page in pages:
    for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text()):
        if "://" not in target and not (page.parent / target).exists():
            broken.append(f"{page.relative_to(ROOT)}: {target}")
print("\n".join(broken) if broken else f"docs: {len(pages)} pages, all links lead somewhere")
sys.exit(1 if broken else 0)
