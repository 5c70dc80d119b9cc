"""What results depend on: the sources, and the programs that were built from them."""

import hashlib
import os
import pathlib

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ("common", "components", "idl", "CMakeLists.txt", "CMakePresets.json", "config/robot.yaml",
           "config/run.yaml", "config/systems", "config/scenes", "config/labels", "launch_scripts/explore.sh", "launch_scripts/lib.sh")


def hash_of_sources(more=()):
    """Of all that programs are made of, of configuration that every run reads, and of `more`, files or folders of the
    repository."""
    digest = hashlib.sha256()
    for source in (*SOURCES, *more):
        path = REPOSITORY / source
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file() and "__pycache__" not in file.parts:
                digest.update(str(file.relative_to(REPOSITORY)).encode() + b"\0" + file.read_bytes())
    furniture = pathlib.Path("/usr/share/sweethome3d/furniture")
    libraries = sorted(p.name for p in furniture.glob("*")) if furniture.is_dir() else ["parametric furniture"]
    digest.update("\n".join(libraries).encode())
    return digest.hexdigest()


def programs():
    return pathlib.Path(os.environ.get("LAPIS_BIN", REPOSITORY / "build/release/bin"))


def problem_of_programs():
    """One line if there is a source that no program knows yet; None otherwise."""
    built = max(program.stat().st_mtime for program in programs().glob("lapis_*"))
    for folder in ("common", "components", "idl"):
        for file in (REPOSITORY / folder).rglob("*"):
            if file.suffix in (".cpp", ".hpp", ".idl") and file.stat().st_mtime > built:
                return f"{file} is newer than the programs: build them first, for rows say which sources made them"
    return None
