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


# An action and its hashes as rosidl has generated them (robot_control_interfaces/action/MoveRobot).
PUBLISHED_ACTION = """
#include "builtin_interfaces.idl"
#include "unique_identifier_msgs.idl"
module robot_control_interfaces { module action {
  struct MoveRobot_Goal {
    string command; int32 mode; int32 speed; float duration; int32 amplitude; int32 times;
  };
  struct MoveRobot_Result {
    int32 error_code; string error_message; string execution_status; float progress; int32 count; int64 start_time;
  };
  struct MoveRobot_Feedback { float progress; string execution_status; int32 error_code; int32 count; };
  struct MoveRobot_SendGoal_Request { unique_identifier_msgs::msg::UUID goal_id; MoveRobot_Goal goal; };
  struct MoveRobot_SendGoal_Response { boolean accepted; builtin_interfaces::msg::Time stamp; };
  struct MoveRobot_GetResult_Request { unique_identifier_msgs::msg::UUID goal_id; };
  struct MoveRobot_GetResult_Response { int8 status; MoveRobot_Result result; };
  struct MoveRobot_FeedbackMessage { unique_identifier_msgs::msg::UUID goal_id; MoveRobot_Feedback feedback; };
}; };
"""
PUBLISHED_ACTION_HASHES = {
    "": "e0c1d4c0611da78de6e6e3ccc0a2b0ab86a426ac4a422df9f8a3086d8ab6bdac",
    "_Goal": "f35a2186b770882b4f0df8df04e866b55c7a052e46bb29588478e89c49345826",
    "_SendGoal": "56c1351617fc4aa59dd454b8f896c823bb49fa8e7cba81c3045e41bf97f28645",
    "_SendGoal_Request": "296890b4ead703ef8a3b193200777f6c6cb0d3c059f24ff7b05df2a772a3157b",
    "_SendGoal_Response": "d7d05b178bcc8d8d45b46cb3172722409acf1618105893434b71bf0ccdbadf05",
    "_GetResult": "abb4591be74a784947490bc56f81cb343de89a725ebe3197195361554e7e6275",
    "_GetResult_Response": "fde7d58bf763f7eb2d9ce6888ea26599d0b6f6ea5c3f12103f7352f57434e532",
    "_FeedbackMessage": "a9c93f8b56155e3f15e7140ffaf63aef9dc60739e5b8e475ff1da2e308523485",
}


class Actions(unittest.TestCase):
    def test_have_the_hashes_of_rosidl(self):
        with package("robot_control_interfaces", PUBLISHED_ACTION) as path:
            library = Library([p.parent for p in type_descriptions.idl_files()])
            library.read(path)
            hashes = type_descriptions.hashes(library)
        for part, value in PUBLISHED_ACTION_HASHES.items():
            self.assertEqual(hashes[f"robot_control_interfaces/action/MoveRobot{part}"], f"RIHS01_{value}", part)

    def test_have_types_for_their_server(self):
        library = library_of_everything()
        path = IDL_DIR / "lapis_msgs" / "lapis_msgs.idl"
        text = type_descriptions.header_text(library, library.read(path), path.name, "x.h")
        self.assertIn("struct ActionSupport<::lapis_msgs::action::Explore> {", text)
        self.assertIn("struct ServiceSupport<::lapis_msgs::action::Explore_SendGoal> {", text)
        self.assertIn('"lapis_msgs::action::dds_::Explore_FeedbackMessage_"', text)


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
        ("module p {\n module other { };\n};\n", 2, "expected module msg, srv or action"),
        ('\n#include "nowhere.idl"\nmodule p { };\n', 2, "no such file"),
        ('#include "p.idl"\nmodule p { };\n', 1, "circular"),
        ("#ifndef A\n#define B\nmodule p { };\n#endif\n", 1, "include guard"),
        ("#ifndef A\n#define A\nmodule p { };\n", 3, "expected #endif"),
        ("module p { module msg {\n module A_Constants { const uint8 X = 1; };\n }; };\n", 2, "no struct A"),
        ("module p { module msg { module A_Constants {\n const uint8 X = 256; }; }; };\n", 2, "not a value of type"),
        ("module p { module msg { module A_Constants {\n const uint8 X = 010; }; }; };\n", 2, "not a value of type"),
        ("module p { module srv {\n struct A_Request { uint8 a; };\n }; };\n", 2, "has no A_Response"),
        ("module p { module srv {\n struct A { uint8 a; };\n }; };\n", 2, "_Request or _Response"),
        ("module p { module action {\n struct A_Goal { uint8 a; };\n }; };\n", 2, "action A has no A_Result"),
        ("module p { module action {\n struct A_Plan { uint8 a; };\n }; };\n", 2, "is none of _Goal, _Result, _Feedback"),
        ("module p { module action {\n struct A_Goal { uint8 a; }; struct A_Result { uint8 a; };\n"
         " struct A_Feedback { uint8 a; };\n struct A_SendGoal_Request { uint8 a; };\n }; };\n", 4,
         "ROS 2 gives it unique_identifier_msgs/msg/UUID goal_id, p/action/A_Goal goal"),
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
