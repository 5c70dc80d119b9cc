"""Type hashes, schemas and the ROS 2 package against known values; the parser against broken files."""

import contextlib
import io
import pathlib
import random
import re
import shutil
import sys
import tempfile
import unittest

TEST_DIR = pathlib.Path(__file__).resolve().parent
IDL_DIR = TEST_DIR.parents[2] / "idl"
sys.path.insert(0, str(IDL_DIR))

import type_descriptions  # noqa: E402
from idl_parser import IdlError, Library  # noqa: E402


def library_of_everything() -> Library:
    library = Library(sorted({p.parent for p in type_descriptions.idl_files()}))
    for path in type_descriptions.idl_files():
        library.read(path)
    return library


def run(*arguments) -> tuple[int, str, str]:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = type_descriptions.main([str(a) for a in arguments])
    return status, out.getvalue(), err.getvalue()


class Hashes(unittest.TestCase):
    def test_equal_those_of_ros2(self):
        lines = (TEST_DIR / "known_hashes.txt").read_text().splitlines()
        known = dict(line.split() for line in lines if not line.startswith("#"))
        ours = type_descriptions.hashes(library_of_everything())
        for name, value in known.items():
            with self.subTest(name):
                self.assertEqual(ours[name], value)
        self.assertGreaterEqual(len(known), 59)
        print(f"{len(known)} hashes compared with ROS 2 Jazzy's")

    def test_depend_on_names_types_and_order_but_not_on_comments_and_constants(self):
        def hash_of(body, before=""):
            with package("p", f"module p {{ module msg {{ {before} struct A {{ {body} }}; }}; }};") as path:
                library = Library([])
                return type_descriptions.struct_hash(library, library.read(path)[0])

        base = hash_of("uint8 a; int32 b;")
        self.assertEqual(base, hash_of("uint8 a; // note\n int32 b;"))
        self.assertEqual(base, hash_of("uint8 a; int32 b;", "module A_Constants { const uint8 ONE = 1; };"))
        self.assertEqual(base, hash_of("@key uint8 a; int32 b;"))
        variants = ["int32 b; uint8 a;", "uint8 c; int32 b;", "octet a; int32 b;", "uint8 a[1]; int32 b;",
                    "sequence<uint8> a; int32 b;", "sequence<uint8, 1> a; int32 b;", "sequence<uint8, 2> a; int32 b;"]
        self.assertEqual(len({base, *map(hash_of, variants)}), len(variants) + 1)


class Schemas(unittest.TestCase):
    def test_of_a_message_with_dependencies(self):
        status, text, _ = run("schema", "std_msgs/msg/Header")
        self.assertEqual(status, 0)
        self.assertEqual(text, "builtin_interfaces/Time stamp\nstring frame_id\n" + "=" * 80 +
                         "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n")

    def test_spell_containers_bounds_and_constants_as_msg_files_do(self):
        _, text, _ = run("schema", "rcl_interfaces/msg/ParameterDescriptor")
        self.assertIn("FloatingPointRange[<=1] floating_point_range\n", text)
        _, text, _ = run("schema", "rmw_dds_common/msg/NodeEntitiesInfo")
        self.assertIn("string<=256 node_name\nGid[] reader_gid_seq\n", text)
        self.assertIn("uint8[16] data\n", text)
        _, text, _ = run("schema", "diagnostic_msgs/msg/DiagnosticStatus")
        self.assertTrue(text.startswith("byte OK=0\n"))
        self.assertIn("byte level\n", text)

    def test_of_an_empty_message_is_empty(self):
        self.assertEqual(run("schema", "std_msgs/msg/Empty"), (0, "", ""))

    def test_define_every_type_they_name(self):
        library = library_of_everything()
        primitive = re.compile(r"(bool|byte|u?int\d+|float\d+|string)(<=\d+)?(\[.*\])?$")
        for struct in library.structs.values():
            own, *parts = type_descriptions.schema(library, struct).split("=" * 80 + "\n")
            defined = {part.split("\n")[0].removeprefix("MSG: ") for part in parts}
            for part, package_name in [(own, struct.package)] + [(p, p[5:].split("/")[0]) for p in parts]:
                for line in part.splitlines():
                    name = line.split()[0].split("[")[0]
                    if line.startswith("MSG: ") or primitive.match(name):
                        continue
                    self.assertIn(name if "/" in name else f"{package_name}/{name}", defined, struct.ros_name)

    def test_of_an_unknown_type_is_refused(self):
        status, _, err = run("schema", "std_msgs/msg/Nothing")
        self.assertEqual(status, 1)
        self.assertIn("unknown type 'std_msgs/msg/Nothing'", err)


class Ros2Package(unittest.TestCase):
    def test_in_the_repository_is_made_from_the_idl(self):
        self.assertEqual(run("ros2-package", "--check"), (0, "", ""), "remedy: idl/type_descriptions.py ros2-package")

    def test_check_finds_changed_missing_and_stale_files(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder) / "lapis_msgs"
            shutil.copytree(IDL_DIR / "ros2" / "lapis_msgs", copy)
            self.assertEqual(run("ros2-package", "--check", "--output", copy)[0], 0)
            (copy / "msg" / "Ack.msg").write_text("uint8 status\n")
            (copy / "msg" / "Tick.msg").unlink()
            (copy / "msg" / "Old.msg").write_text("")
            status, _, err = run("ros2-package", "--check", "--output", copy)
            self.assertEqual(status, 1)
            for fault in ["Ack.msg: differs", "Tick.msg: missing", "Old.msg: not made"]:
                self.assertIn(fault, err)


@contextlib.contextmanager
def package(name: str, text: str):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / f"{name}.idl"
        path.write_text(text)
        yield path


def in_struct(member: str) -> str:
    return f"module p {{\n module msg {{\n  struct A {{\n   {member}\n  }};\n }};\n}};\n"


class ParserErrors(unittest.TestCase):
    CASES = [
        (in_struct("uint8 a"), 5, "expected ';'"),
        (in_struct("uint7 a;"), 4, "unknown type"),
        (in_struct("std_msgs::msg::Header a;"), 4, "#include it first"),
        (in_struct("uint8 a; uint8 a;"), 4, "two members 'a'"),
        (in_struct("uint8 badName;"), 4, "not in snake_case"),
        (in_struct("uint8 a[0];"), 4, "at least 1"),
        (in_struct("sequence<sequence<uint8>> a;"), 4, "sequence of sequences"),
        (in_struct("sequence<uint8> a[2];"), 4, "array of sequences"),
        (in_struct("@optional uint8 a;"), 4, "expected 'key'"),
        (in_struct("uint8 a; $"), 4, "unexpected '$'"),
        (in_struct(""), 3, "structure_needs_at_least_one_member"),
        ("module q { };\n", 1, "must live in q.idl"),
        ("module p {\n module action { };\n};\n", 2, "expected module msg or srv"),
        ('\n#include "nowhere.idl"\nmodule p { };\n', 2, "no such file"),
        ('#include "p.idl"\nmodule p { };\n', 1, "circular"),
        ("#ifndef A\n#define B\nmodule p { };\n#endif\n", 1, "include guard"),
        ("#ifndef A\n#define A\nmodule p { };\n", 3, "expected #endif"),
        ("module p { module msg {\n module A_Constants { const uint8 X = 1; };\n }; };\n", 2, "no struct A"),
        ("module p { module msg { module A_Constants {\n const uint8 X = 256; }; }; };\n", 2, "not a value of type"),
        ("module p { module msg { module A_Constants {\n const uint8 X = 010; }; }; };\n", 2, "not a value of type"),
        ("module p { module srv {\n struct A_Request { uint8 a; };\n }; };\n", 2, "has no A_Response"),
        ("module p { module srv {\n struct A { uint8 a; };\n }; };\n", 2, "_Request or _Response"),
    ]

    def test_name_file_and_line(self):
        for text, line, message in self.CASES:
            with self.subTest(text), package("p", text) as path:
                with self.assertRaises(IdlError) as caught:
                    Library([]).read(path)
                self.assertTrue(str(caught.exception).startswith(f"{path}:{line}: "), str(caught.exception))
                self.assertIn(message, str(caught.exception))

    def test_reach_the_command_line(self):
        with package("p", in_struct("uint7 a;")) as path:
            status, _, err = run("list", path)
            self.assertEqual(status, 1)
            self.assertIn(f"{path}:4: unknown type", err)
        status, _, err = run("list", "missing.idl")
        self.assertEqual(status, 1)
        self.assertIn("missing.idl:1: cannot be read", err)


class ParserFuzz(unittest.TestCase):
    """Broken files end in IdlError, never in another exception, in silence or in a hang (the test's time-out)."""

    def setUp(self):
        self.random = random.Random(7)
        self.folders = sorted({p.parent for p in type_descriptions.idl_files()})

    def parse(self, name: str, text: str):
        with package(name, text) as path:
            return Library(self.folders).read(path)

    def test_truncation_is_an_error(self):
        for path in type_descriptions.idl_files():
            text = path.read_text().rstrip()
            for cut in self.random.sample(range(len(text)), min(25, len(text))):
                with self.subTest(f"{path.name} cut at {cut}"), self.assertRaises(IdlError):
                    self.parse(path.stem, text[:cut])

    def test_mutation_is_an_error_or_a_valid_file(self):
        for path in type_descriptions.idl_files():
            text = path.read_text()
            for _ in range(15):
                start = self.random.randrange(len(text))
                length = self.random.randrange(4)
                insert = "".join(self.random.choice('{}<>;:,"#/*\n@a1[] ') for _ in range(self.random.randrange(3)))
                with contextlib.suppress(IdlError):
                    self.parse(path.stem, text[:start] + insert + text[start + length:])


if __name__ == "__main__":
    unittest.main()
