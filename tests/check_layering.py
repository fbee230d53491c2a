#!/usr/bin/env python3
"""Checks the arrows of docs/architecture.md: which folder may include which, and who may include a third-party header.

usage: check_layering.py [ROOT]      exit code 1 and one line per mistake
       check_layering.py --self-test
"""

import re
import sys
import tempfile
from fnmatch import fnmatch
from pathlib import Path

# Folder of the house -> the folders it may include. Include paths start with the key: "core/problem.h".
ALLOWED = {"core": set(), "linalg": {"core"}, "geometry": {"core", "linalg"}}
ALLOWED["energies"] = ALLOWED["geometry"] | {"geometry"}
ALLOWED["dynamics"] = ALLOWED["energies"] | {"energies"}
ALLOWED["constraints"] = {"core", "linalg", "geometry"}
ALLOWED["files"] = {"core", "linalg", "geometry"}
ALLOWED["solvers"] = {"core", "linalg"}
ALLOWED["problems"] = ALLOWED["dynamics"] | {"dynamics", "constraints", "solvers", "files"}
ALLOWED["study"] = ALLOWED["problems"] | {"problems"}
ALLOWED["report"] = ALLOWED["study"] | {"study"}
ALLOWED["cli"] = ALLOWED["report"] | {"report"}

AT_TOP = ("constraints", "solvers", "problems")  # the other folders are in src/

JSON_USERS = ("problems/*.cpp", "src/files/*.cpp", "src/study/*.cpp", "src/report/*.cpp", "src/cli/*.cpp", "tests/*")
# Third-party headers: pattern of the header -> patterns of the files that may include it. The first match counts;
# `*` also matches `/`. A header that no line names is a mistake, so that a new library is a decision.
THIRD_PARTY = [
    ("Eigen/*Support", ("src/linalg/*.cpp",)),
    ("Eigen/*", ("*",)),
    ("CGAL/*", ("src/geometry/*_cgal.cpp",)),
    ("cholmod*", ("src/linalg/*.cpp",)),
    ("suitesparse/*", ("src/linalg/*.cpp",)),
    ("SuiteSparse*", ("src/linalg/*.cpp",)),
    ("metis.h", ("src/linalg/*.cpp",)),
    ("dmumps_c.h", ("src/linalg/*.cpp",)),
    ("cblas.h", ("src/linalg/*.cpp",)),
    ("omp.h", ("src/linalg/*.cpp",)),
    ("dlfcn.h", ("src/linalg/*.cpp",)),
    ("tbb/*", ("src/core/*.cpp",)),
    ("oneapi/*", ("src/core/*.cpp",)),
    ("Ip[A-Z]*.hpp", ("solvers/ipopt.cpp",)),
    ("nlopt.h", ("solvers/nlopt.cpp",)),
    ("Spectra/*", ("src/dynamics/modal/eigen_solver.cpp",)),
    ("asl*.h", ("problems/nl_model.cpp",)),
    ("nlp.h", ("problems/nl_split.cpp",)),
    ("malloc.h", ("src/cli/main.cpp",)),
    ("CLI/*", ("src/cli/*.cpp",)),
    ("spdlog/*", ("src/cli/*.cpp",)),
    ("nlohmann/json_fwd.hpp", JSON_USERS + ("problems/*.h", "src/files/*.h", "src/study/*.h", "src/report/*.h", "src/cli/*.h")),
    ("nlohmann/*", JSON_USERS),
    ("fmt/*", JSON_USERS),
    ("valijson/*", ("tests/problems/*.cpp",)),
    ("zlib.h", ("src/files/*.cpp", "tests/*")),
    ("gtest/*", ("tests/*",)),
    ("gmock/*", ("tests/*",)),
    ("rapidcheck*", ("tests/*",)),
    ("benchmark/*", ("tests/benchmarks/*.cpp",)),
]
POSIX = re.compile(r"(sys/\w+|netinet/in|poll|unistd|signal|fcntl|glob|termios|pthread|pty)\.h")  # in any .cpp, and in tests

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
COMMENT = re.compile(r'R"(\w*)\(.*?\)\1"|/\*.*?\*/|//[^\n]*', re.DOTALL)


def source_folder(root, folder):
    return root / folder if folder in AT_TOP else root / "src" / folder


def files_below(folder):
    return sorted(path for path in folder.rglob("*") if path.suffix in (".h", ".hpp", ".cpp"))


def includes(path):
    """(bracket, header, line) of every #include that is not in a comment or a raw string."""
    text = path.read_text(encoding="utf-8")
    text = COMMENT.sub(lambda match: "\n" * match.group().count("\n"), text)
    return [(m.group(1), m.group(2), text.count("\n", 0, m.start(1)) + 1) for m in INCLUDE.finditer(text)]


def cycle_in(graph):
    """The first cycle found in {node: set of nodes}, as a list whose first and last entries agree; else None."""
    done = set()

    def visit(node, path):
        if node in path:
            return path[path.index(node):] + [node]
        if node in done:
            return None
        for successor in sorted(graph.get(node, ())):
            found = visit(successor, path + [node])
            if found:
                return found
        done.add(node)
        return None

    for node in sorted(graph):
        found = visit(node, [])
        if found:
            return found
    return None


class Check:
    def __init__(self, root):
        self.root = root
        self.mistakes = []
        self.folder_graph = {}
        self.file_graph = {}

    def run(self):
        for path in sorted((self.root / "src").glob("*")):
            if path.is_dir() and (path.name not in ALLOWED or path.name in AT_TOP):
                self.mistakes.append(f"src/{path.name}: not a folder of the house (docs/architecture.md)")
        for folder in ALLOWED:
            for path in files_below(source_folder(self.root, folder)):
                self.check_file(path, folder)
        for path in files_below(self.root / "tests"):
            self.check_file(path, "tests")
        for what, graph in (("folders", self.folder_graph), ("files", self.file_graph)):
            cycle = cycle_in(graph)
            if cycle:
                self.mistakes.append(f"{what} include each other: {' -> '.join(cycle)}")
        self.check_link_lines()
        return self.mistakes

    def check_file(self, path, folder):
        name = path.relative_to(self.root).as_posix()
        if path.suffix != ".cpp" and not re.search(r"^#pragma once$", path.read_text(encoding="utf-8"), re.MULTILINE):
            self.mistakes.append(f"{name}:1: a header without #pragma once")
        for bracket, header, line in includes(path):
            mistake = self.own(path, folder, header) if bracket == '"' else self.third_party(name, header)
            if mistake:
                self.mistakes.append(f"{name}:{line}: {mistake}")

    def own(self, path, folder, header):
        """What is wrong with #include "header" in `path`, or None."""
        target = header.split("/")[0]
        if ".." in header.split("/") or target == "src":
            return f'"{header}": write the path from src/ or the top, as in "core/problem.h"'
        if folder == "tests" and target in ("support", "benchmarks"):
            resolved = self.root / "tests" / header
        elif folder == "tests" and target == "tests":
            resolved = self.root / header
        elif target in ALLOWED and "/" in header:
            resolved = source_folder(self.root, target) / header[len(target) + 1:]
        else:
            return f'"{header}": no folder of the house begins this path (third-party headers go in <>)'
        if folder != "tests" and target != folder:
            self.folder_graph.setdefault(folder, set()).add(target)
            if target not in ALLOWED[folder]:
                allowed = ", ".join(sorted(ALLOWED[folder])) or "nothing"
                return f'"{header}": {folder} may include {allowed}, not {target}'
        if not resolved.is_file():
            return f'"{header}": there is no such file'
        self.file_graph.setdefault(path.relative_to(self.root).as_posix(), set()).add(
            resolved.relative_to(self.root).as_posix())
        return None

    def third_party(self, name, header):
        """What is wrong with #include <header> in the file called `name`, or None."""
        if header.split("/")[0] in ALLOWED:
            return f'<{header}>: our own headers go in ""'
        for pattern, users in THIRD_PARTY:
            if fnmatch(header, pattern):
                if any(fnmatch(name, user) for user in users):
                    return None
                return f"<{header}>: only {', '.join(users)} may include it"
        if POSIX.fullmatch(header):
            right = name.endswith(".cpp") or name.startswith("tests/")
            return None if right else f"<{header}>: system headers stay in .cpp files"
        if "/" in header or "." in header:
            return f"<{header}>: unknown library; say in tests/check_layering.py who wraps it"
        return None

    def check_link_lines(self):
        """The DEPENDS of taut_library() in CMakeLists.txt reach exactly the folders of the table."""
        path = self.root / "CMakeLists.txt"
        if not path.is_file():
            return
        lines = re.findall(r"^taut_library\((\w+) \S+([^)]*)\)", path.read_text(encoding="utf-8"), re.MULTILINE)
        direct = {name: set(re.findall(r"\btaut_(\w+)", rest)) for name, rest in lines}
        for name in direct:
            reached, waiting = set(), [name]
            while waiting:
                new = direct.get(waiting.pop(), set()) - reached
                reached |= new
                waiting += new
            if name not in ALLOWED or reached != ALLOWED[name]:
                self.mistakes.append(f"CMakeLists.txt: taut_{name} links {', '.join(sorted(reached)) or 'nothing'}, "
                                     f"the arrows say {', '.join(sorted(ALLOWED.get(name, ()))) or 'nothing'}")


# Trees for the self-test: what is wrong, the files, and a part of the message expected (None: the tree is right).
HEADER = "#pragma once\n"
TREES = [
    ("nothing", {"src/core/a.h": HEADER + "#include <vector>\n#include <Eigen/Core>\n",
                 "src/linalg/b.h": HEADER + '#include "core/a.h"\n',
                 "src/linalg/b.cpp": '#include "linalg/b.h"\n#include <cholmod.h>\n#include <metis.h>\n',
                 "src/core/p.cpp": "#include <tbb/parallel_for.h>\n",
                 "src/geometry/m_cgal.cpp": "#include <CGAL/Surface_mesh.h>\n",
                 "constraints/c.h": HEADER + '#include "linalg/b.h"\n',
                 "problems/s.h": HEADER + '#include <nlohmann/json_fwd.hpp>\n#include "constraints/c.h"\n',
                 "problems/s.cpp": '#include "problems/s.h"\n#include <nlohmann/json.hpp>\n',
                 "src/cli/main.cpp": '#include <CLI/CLI.hpp>\n#include <unistd.h>\n#include "problems/s.h"\n',
                 "tests/support/t.h": HEADER,
                 "tests/core/fixture.h": HEADER + "#include <unistd.h>\n",
                 "tests/core/b_test.cpp": '#include "tests/core/fixture.h"\n',
                 "tests/core/a_test.cpp": '#include <gtest/gtest.h>\n#include "core/a.h"\n#include "support/t.h"\n',
                 "CMakeLists.txt": "taut_library(core src/core PRIVATE TBB::tbb)\ntaut_library(linalg src/linalg DEPENDS taut_core)\n"},
     None),
    ("commented-out include", {"src/core/a.h": HEADER + '// #include "cli/x.h"\n/*\n#include "cli/x.h"\n*/\n'}, None),
    ("include in a raw string", {"src/core/a.cpp": 'auto s = R"(\n#include "cli/x.h"\n)";\n'}, None),
    ("upward include", {"src/core/a.cpp": '#include "linalg/b.h"\n', "src/linalg/b.h": HEADER}, "core may include nothing"),
    ("solver sees a constraint", {"solvers/s.cpp": '#include "constraints/c.h"\n', "constraints/c.h": HEADER},
     "solvers may include core, linalg, not constraints"),
    ("constraint sees a solver", {"constraints/c.cpp": '#include "solvers/s.h"\n', "solvers/s.h": HEADER}, "not solvers"),
    ("solver sees geometry", {"solvers/s.cpp": '#include "geometry/g.h"\n', "src/geometry/g.h": HEADER}, "not geometry"),
    ("product sees tests", {"src/core/a.cpp": '#include "support/t.h"\n', "tests/support/t.h": HEADER}, "no folder of the house"),
    ("product sees a test's header", {"src/core/a.cpp": '#include "tests/core/t.h"\n', "tests/core/t.h": HEADER}, "no folder of the house"),
    ("system header in a header", {"src/core/a.h": HEADER + "#include <unistd.h>\n"}, "system headers stay in .cpp files"),
    ("mutual includes", {"src/files/a.h": HEADER + '#include "problems/b.h"\n', "problems/b.h": HEADER + '#include "files/a.h"\n'},
     "folders include each other: files -> problems -> files"),
    ("cycle of three", {"src/core/a.h": HEADER + '#include "energies/c.h"\n', "src/linalg/b.h": HEADER + '#include "core/a.h"\n',
                        "src/energies/c.h": HEADER + '#include "linalg/b.h"\n'},
     "folders include each other: core -> energies -> linalg -> core"),
    ("files of one folder in a ring", {"src/core/a.h": HEADER + '#include "core/b.h"\n', "src/core/b.h": HEADER + '#include "core/a.h"\n'},
     "files include each other: src/core/a.h -> src/core/b.h -> src/core/a.h"),
    ("CGAL outside its file", {"src/geometry/topology.cpp": "#include <CGAL/Surface_mesh.h>\n"}, "src/geometry/topology.cpp:1: <CGAL/"),
    ("CHOLMOD in a solver", {"solvers/n.cpp": "\n#include <suitesparse/cholmod.h>\n"}, "solvers/n.cpp:2: <suitesparse/"),
    ("CHOLMOD in a header", {"src/linalg/f.h": HEADER + "#include <cholmod.h>\n"}, "src/linalg/f.h:2: <cholmod.h>"),
    ("CHOLMOD by way of Eigen", {"solvers/n.cpp": "#include <Eigen/CholmodSupport>\n"}, "<Eigen/CholmodSupport>: only"),
    ("TBB in energies", {"src/energies/e.cpp": "#include <tbb/task_arena.h>\n"}, "<tbb/task_arena.h>: only"),
    ("CLI11 in study", {"src/study/s.cpp": "#include <CLI/CLI.hpp>\n"}, "<CLI/CLI.hpp>: only"),
    ("spdlog in report", {"src/report/r.cpp": "#include <spdlog/spdlog.h>\n"}, "<spdlog/spdlog.h>: only"),
    ("JSON in a header", {"problems/s.h": HEADER + "#include <nlohmann/json.hpp>\n"}, "<nlohmann/json.hpp>: only"),
    ("JSON in core", {"src/core/a.cpp": "#include <nlohmann/json_fwd.hpp>\n"}, "<nlohmann/json_fwd.hpp>: only"),
    ("valijson in the product", {"problems/v.cpp": "#include <valijson/validator.hpp>\n"}, "<valijson/validator.hpp>: only"),
    ("test library in the product", {"src/core/a.cpp": "#include <gtest/gtest.h>\n"}, "<gtest/gtest.h>: only"),
    ("unknown library", {"src/core/a.cpp": "#include <boost/any.hpp>\n"}, "unknown library"),
    ("no #pragma once", {"src/core/a.h": "#include <vector>\n"}, "a header without #pragma once"),
    ("relative path", {"src/core/a.h": HEADER, "src/linalg/b.cpp": '#include "../core/a.h"\n'}, "write the path from src/"),
    ("own header in <>", {"src/core/a.h": HEADER, "src/linalg/b.cpp": "#include <core/a.h>\n"}, "our own headers"),
    ("file that is not there", {"src/linalg/b.cpp": '#include "core/gone.h"\n'}, "there is no such file"),
    ("folder outside the house", {"src/utils/a.h": HEADER}, "src/utils: not a folder of the house"),
    ("link line without its arrow", {"CMakeLists.txt": "taut_library(solvers solvers DEPENDS taut_core)\n"},
     "taut_solvers links core, the arrows say core, linalg"),
]


def self_test():
    failed = 0
    for what, files, expected in TREES:
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                path = Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            mistakes = Check(Path(folder)).run()
        right = not mistakes if expected is None else any(expected in mistake for mistake in mistakes)
        if not right:
            failed += 1
            print(f"self-test '{what}': expected {expected or 'no mistake'}, found {mistakes or 'no mistake'}")
    if cycle_in(ALLOWED):
        failed += 1
        print(f"the table itself has a cycle: {cycle_in(ALLOWED)}")
    print(f"self-test: {len(TREES) + 1 - failed} passed, {failed} failed")
    return failed == 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return 0 if self_test() else 1
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    mistakes = Check(root.resolve()).run()
    print("\n".join(mistakes) if mistakes else "layering: every include follows an arrow of docs/architecture.md")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
