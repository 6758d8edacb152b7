#!/usr/bin/python3
"""Checks the ranks of the house on #include lines, and where things may not be.

A library includes only libraries of a lower rank; third-party headers other than Eigen stay out of public headers;
printing is for app alone; threads only through core/parallel; files only in io, view, pipeline, serve.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FILE_LIBRARIES = {"io", "view", "pipeline", "serve"}
THIRD_PARTY = re.compile(r'#include\s*[<"](itk|vtk|nlohmann|toml|CLI|spdlog|fmt|embree|gdcm|nanoflann|boost|oneapi|tbb|png|zlib)')
RULES = [  # pattern, libraries it is allowed in, what it is
    (re.compile(r"\bstd::(cout|cerr|clog)\b|\b(printf|puts)\s*\("), {"app"}, "printing"),
    (re.compile(r"#include\s*<(thread|future|mutex|omp\.h|oneapi/tbb|tbb)"), {"core", "app", "serve"}, "threads"),
    (re.compile(r"\bstd::(i|o)?fstream\b"), FILE_LIBRARIES | {"app"}, "files"),
]


def ranks():
    found = {}
    for path in ROOT.glob("src/*/CMakeLists.txt"):
        match = re.search(r"coxa_library\(\s*(\w+)\s+RANK\s+(\d+)", path.read_text())
        if match:
            found[match[1]] = int(match[2])
    return found | {"app": 9}


def problems_in(path, library, rank, public):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        where = f"{path.relative_to(ROOT)}:{number}"
        match = re.search(r"#include\s*<coxa/(\w+)/", line)
        if match and match[1] != library:
            other = match[1]
            if other not in rank:
                yield f"{where}: includes unknown library {other}"
            elif rank[other] >= rank[library]:
                yield f"{where}: {library} (rank {rank[library]}) may not include {other} (rank {rank[other]})"
        if public and THIRD_PARTY.search(line):
            yield f"{where}: third-party header in a public header"
        code = line.split("//")[0]
        for pattern, allowed, what in RULES:
            if library not in allowed and pattern.search(code):
                yield f"{where}: {what} does not belong in {library}"


def main():
    rank, problems = ranks(), []
    for library in sorted(rank):
        for path in sorted((ROOT / "include/coxa" / library).glob("**/*.h")):
            problems += problems_in(path, library, rank, public=True)
        for path in sorted((ROOT / "src" / library).glob("**/*.*")):
            if path.suffix in {".h", ".cpp"} and path != ROOT / "src/core/error.cpp":
                problems += problems_in(path, library, rank, public=False)
    print("\n".join(problems) if problems else f"layers: {len(rank)} libraries ok")
    sys.exit(1 if problems else 0)


main()
