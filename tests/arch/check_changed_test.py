"""Would fail if check_changed.py, which CI runs, passed over a forgotten #include in a source of tools/, in
a header, or in a benchmark whose header changed, or if an older commit's files were checked, too.

Usage: check_changed_test.py SOURCE_FOLDER
"""

import json
import pathlib
import subprocess
import sys
import tempfile

CHECK = pathlib.Path(sys.argv[1]) / "tests/arch/check_changed.py"


def commit(folder, date, **files):
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    subprocess.run(["git", "-C", folder, "add", "."], check=True)
    subprocess.run(["git", "-C", folder, "-c", "user.name=t", "-c", "user.email=t@t", "commit", "-qm", "c"],
                   check=True, env={"PATH": "/usr/bin:/bin", "GIT_COMMITTER_DATE": date, "GIT_AUTHOR_DATE": date})


def check(folder):
    done = subprocess.run([sys.executable, CHECK, folder, folder / "build", "--syntax-only"],
                          capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name).resolve()
    subprocess.run(["git", "init", "-q", folder], check=True)
    broken = "std::vector<int> numbers();\n"
    whole = "#include <vector>\n" + broken
    commit(folder, "2001-01-01T00:00:00", **{
        "lib/old.cpp": broken, "tools/krok-a/run.cpp": whole, "lib/a.h": "#pragma once\n" + whole,
        "tests/bench/a_bench.cpp": '#include "a.h"\nint used = missing;\n', ".gitignore": "build\n"})
    sources = ["lib/old.cpp", "tools/krok-a/run.cpp", "tests/bench/a_bench.cpp"]
    (folder / "build").mkdir()
    (folder / "build/compile_commands.json").write_text(json.dumps([
        {"directory": str(folder), "file": str(folder / source),
         "command": f"/usr/bin/c++ -std=c++20 -I{folder}/lib -o x.o -c {folder / source}"} for source in sources]))

    def expect(what, code, *words):
        found, text = check(folder)
        if found != code or any(word not in text for word in words):
            sys.exit(f"{what}: exit code {found}, expected {code} and {words}:\n{text}")

    expect("nothing changed", 0, "compiled alone: 0")
    (folder / "tools/krok-a/run.cpp").write_text(broken)
    expect("an include is missing in tools/", 1, "tools/krok-a/run.cpp")
    (folder / "tools/krok-a/run.cpp").write_text("#include <vector>\n\n" + broken)
    expect("it is there again", 0, "compiled alone: 1")
    (folder / "lib/a.h").write_text("#pragma once\n" + broken)
    expect("an include is missing in a header, which a benchmark includes", 1, "lib/a.h", "a_bench.cpp")
