#!/usr/bin/env python3
"""ROS 2 names, type hashes and schemas of the IDL files; python3 standard library only.

The build calls `header` and `table`. By hand: `list`, `schema` and `ros2-package [--check]`.
"""

from __future__ import annotations

import argparse
import dataclasses
import hashlib
import json
import pathlib
import sys

from idl_parser import Field, IdlError, Library, Struct, Type

IDL_DIR = pathlib.Path(__file__).resolve().parent
SERVICE_EVENT_INFO = "service_msgs/msg/ServiceEventInfo"

# type_description_interfaces/msg/FieldType of ROS 2
TYPE_IDS = {"int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9,
            "float32": 10, "float64": 11, "bool": 15, "byte": 16, "string": 17}
NESTED_TYPE_ID, BOUNDED_STRING_ID = 1, 21
CONTAINER_OFFSET = {"": 0, "array": 48, "bounded": 96, "unbounded": 144}


# ---- type hashes (RIHS01, REP 2011) -------------------------------------------------------------------------------

def field_description(field: Field) -> dict:
    type_ = field.type
    base = NESTED_TYPE_ID if type_.is_struct else BOUNDED_STRING_ID if type_.string_bound else TYPE_IDS[type_.name]
    return {"name": field.name,
            "type": {"type_id": base + CONTAINER_OFFSET[type_.container], "capacity": type_.capacity,
                     "string_capacity": type_.string_bound, "nested_type_name": type_.name if type_.is_struct else ""}}


def referenced(structs: dict[str, Struct], fields) -> dict[str, Struct]:
    """The structs that `fields` use, directly or not, in order of name."""
    found: dict[str, Struct] = {}
    todo = [f.type.name for f in fields if f.type.is_struct]
    while todo:
        name = todo.pop()
        if name not in found:
            found[name] = structs[name]
            todo += [f.type.name for f in structs[name].fields if f.type.is_struct]
    return dict(sorted(found.items()))


def type_hash(structs: dict[str, Struct], ros_name: str, fields) -> str:
    def description(name, members):
        return {"type_name": name, "fields": [field_description(f) for f in members]}

    document = {"type_description": description(ros_name, fields),
                "referenced_type_descriptions": [description(name, struct.fields)
                                                 for name, struct in referenced(structs, fields).items()]}
    return "RIHS01_" + hashlib.sha256(json.dumps(document).encode("ascii")).hexdigest()


def struct_hash(library: Library, struct: Struct) -> str:
    return type_hash(library.structs, struct.ros_name, struct.fields)


def service_event(library: Library, service: str) -> Struct:
    """The event message ROS 2 derives from a service; never on our wire, but part of the service's hash."""
    if SERVICE_EVENT_INFO not in library.structs:
        library.read(IDL_DIR / "ros" / "service_msgs" / "service_msgs.idl")
    fields = (Field(Type(SERVICE_EVENT_INFO), "info"),
              Field(Type(service + "_Request", container="bounded", capacity=1), "request"),
              Field(Type(service + "_Response", container="bounded", capacity=1), "response"))
    request = library.structs[service + "_Request"]
    return dataclasses.replace(request, name=service.rpartition("/")[2] + "_Event", fields=fields, constants=())


def service_hash(library: Library, service: str) -> str:
    event = service_event(library, service)
    fields = (Field(Type(service + "_Request"), "request_message"),
              Field(Type(service + "_Response"), "response_message"),
              Field(Type(event.ros_name), "event_message"))
    return type_hash({**library.structs, event.ros_name: event}, service, fields)


def services(structs) -> list[str]:
    return [s.ros_name.removesuffix("_Request") for s in structs
            if s.section == "srv" and s.name.endswith("_Request")]


def hashes(library: Library) -> dict[str, str]:
    """Every struct, service and service event of the library with its hash, sorted by name."""
    result = {s.ros_name: struct_hash(library, s) for s in list(library.structs.values())}
    for service in services(list(library.structs.values())):
        event = service_event(library, service)
        result[service] = service_hash(library, service)
        result[event.ros_name] = struct_hash(library, event)
    return dict(sorted(result.items()))


# ---- .msg text ----------------------------------------------------------------------------------------------------

def msg_type(struct: Struct, type_: Type) -> str:
    name = type_.name
    if type_.is_struct:     # ROS writes the package only where it differs from the file's
        package, _, base = name.split("/")
        name = base if (package, struct.section) == (struct.package, "msg") else f"{package}/{base}"
    elif type_.string_bound:
        name = f"string<={type_.string_bound}"
    return name + {"": "", "array": f"[{type_.capacity}]", "bounded": f"[<={type_.capacity}]",
                   "unbounded": "[]"}[type_.container]


def msg_value(value: str) -> str:
    return {"TRUE": "true", "FALSE": "false"}.get(value, value)


def msg_lines(struct: Struct, with_comments: bool) -> list[str]:
    def block(item, text):
        above = [f"# {c}".rstrip() for c in item.comments] if with_comments else []
        after = f"  # {item.comment_after}" if with_comments and item.comment_after else ""
        return [*above, text + after]

    lines = [f"# {c}".rstrip() for c in struct.comments] + [""] if with_comments and struct.comments else []
    for constant in struct.constants:
        lines += block(constant, f"{constant.type} {constant.name}={msg_value(constant.value)}")
    if with_comments and struct.constants and not struct.is_empty:
        lines.append("")
    if not struct.is_empty:
        for field in struct.fields:
            lines += block(field, f"{msg_type(struct, field.type)} {field.name}")
    return lines


def schema(library: Library, struct: Struct) -> str:
    """Schema `ros2msg` of an MCAP file: the message's text, then that of every type it uses, as rosbag2 joins them."""
    text = "".join(line + "\n" for line in msg_lines(struct, with_comments=False))
    for used in referenced(library.structs, struct.fields).values():
        text += "=" * 80 + f"\nMSG: {used.package}/{used.name}\n"
        text += "".join(line + "\n" for line in msg_lines(used, with_comments=False))
    return text


# ---- C++ ----------------------------------------------------------------------------------------------------------

def dds_name(struct: Struct) -> str:
    return f"{struct.package}::{struct.section}::dds_::{struct.name}_"


def header_text(library: Library, structs: list[Struct], source: str, type_header: str) -> str:
    lines = [f"// Made from {source} by type_descriptions.py.", "#pragma once", "",
             f'#include "{type_header}"', '#include "idl/type_support.hpp"', ""]
    names = services(structs)
    for service in names:
        package, _, name = service.split("/")
        lines.append(f"namespace {package}::srv {{ struct {name}; }}")
    lines += ["", "namespace lapis::idl {", ""]
    for struct in structs:
        cpp = f"::{struct.package}::{struct.section}::{struct.name}"
        is_keyed = "true" if any(f.is_key for f in struct.fields) else "false"
        lines += ["template <>", f"struct TypeSupport<{cpp}> {{",
                  f"  using PubSubType = {cpp}PubSubType;",
                  f'  static constexpr const char* kRosName = "{struct.ros_name}";',
                  f'  static constexpr const char* kDdsName = "{dds_name(struct)}";',
                  f'  static constexpr const char* kHash = "{struct_hash(library, struct)}";',
                  f"  static constexpr bool kIsKeyed = {is_keyed};", "};", ""]
    for service in names:
        cpp = "::" + service.replace("/", "::")
        lines += ["template <>", f"struct ServiceSupport<{cpp}> {{",
                  f"  using Request = {cpp}_Request;", f"  using Response = {cpp}_Response;",
                  f'  static constexpr const char* kRosName = "{service}";',
                  f'  static constexpr const char* kHash = "{service_hash(library, service)}";', "};", ""]
    lines += ["}  // namespace lapis::idl", ""]
    return "\n".join(lines)


def fields_name(struct: Struct) -> str:
    return f"kFieldsOf_{struct.ros_name.replace('/', '_')}"


def table_text(library: Library, structs: list[Struct]) -> str:
    lines = ["// Made by type_descriptions.py.", '#include "idl/type_table.hpp"', "", "#include <algorithm>", "",
             "namespace lapis::idl {", "namespace {", ""]
    structs = sorted(structs, key=lambda s: s.ros_name)
    for struct in structs:
        lines.append(f"constexpr FieldEntry {fields_name(struct)}[] = {{")
        for description in map(field_description, struct.fields):
            type_ = description["type"]
            lines.append(f'    {{"{description["name"]}", {type_["type_id"]}, {type_["capacity"]}, '
                         f'{type_["string_capacity"]}, "{type_["nested_type_name"]}"}},')
        lines.append("};")
    lines += ["", "constexpr TypeEntry kTypes[] = {"]
    for struct in structs:
        lines.append(f'    {{"{struct.ros_name}", "{dds_name(struct)}",')
        lines.append(f'     "{struct_hash(library, struct)}",')
        schema_lines = schema(library, struct).splitlines(keepends=True) or [""]
        lines += [f"     {json.dumps(line)}" for line in schema_lines]
        lines[-1] += f", {fields_name(struct)}}},"
    lines += ["};", "", "}  // namespace", "",
              "std::span<const TypeEntry> type_table() { return kTypes; }", "",
              "const TypeEntry* find(std::string_view ros_name) {",
              "  const auto* entry = std::ranges::lower_bound(kTypes, ros_name, {}, &TypeEntry::ros_name);",
              "  return entry != std::end(kTypes) && entry->ros_name == ros_name ? entry : nullptr;",
              "}", "", "}  // namespace lapis::idl", ""]
    return "\n".join(lines)


# ---- ROS 2 interface package --------------------------------------------------------------------------------------

def package_xml(package: str, dependencies: list[str]) -> str:
    depends = "".join(f"  <depend>{d}</depend>\n" for d in dependencies)
    return f"""<?xml version="1.0"?>
<package format="3">
  <name>{package}</name>
  <version>0.1.0</version>
  <description>Messages of Lapis, for ROS 2 tools. Made from idl/{package}/{package}.idl; do not edit.</description>
  <maintainer email="lapis@example.org">Lapis developers</maintainer>
  <license>Apache-2.0</license>

  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
{depends}  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>

  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""


def package_cmake(package: str, files: list[str], dependencies: list[str]) -> str:
    needed = ["ament_cmake", "rosidl_default_generators", *dependencies]
    finds = "".join(f"find_package({name} REQUIRED)\n" for name in needed)
    listing = "".join(f"  {f}\n" for f in files)
    return f"""# Made from idl/{package}/{package}.idl; do not edit.
cmake_minimum_required(VERSION 3.8)
project({package})

{finds}
rosidl_generate_interfaces(${{PROJECT_NAME}}
{listing}  DEPENDENCIES {' '.join(dependencies)})

ament_export_dependencies(rosidl_default_runtime)
ament_package()
"""


def ros2_package(structs: list[Struct]) -> dict[str, str]:
    """The files of a rosidl package with these types: relative path -> text."""
    package = structs[0].package
    used = {f.type.name.split("/")[0] for s in structs for f in s.fields if f.type.is_struct}
    dependencies = sorted(used - {package})
    files = {}
    for struct in structs:
        if struct.section != "msg":
            raise IdlError(struct.path, struct.line, "services are not written to ROS 2 packages yet")
        lines = [f"# Made from idl/{package}/{package}.idl; do not edit."]
        if any(f.is_key for f in struct.fields):
            lines.append("# Keyed on DDS: it lives on a topic that ROS 2 cannot subscribe to. For reading recordings.")
        lines += ["", *msg_lines(struct, with_comments=True)]
        files[f"msg/{struct.name}.msg"] = "\n".join(lines) + "\n"
    messages = sorted(files)
    files["package.xml"] = package_xml(package, dependencies)
    files["CMakeLists.txt"] = package_cmake(package, messages, dependencies)
    return files


def check_package(files: dict[str, str], directory: pathlib.Path) -> list[str]:
    """What differs between the files and the directory; empty when nothing does."""
    present = {str(p.relative_to(directory)) for p in directory.rglob("*") if p.is_file()}
    faults = [f"{directory / name}: not made from the IDL any more" for name in sorted(present - set(files))]
    for name, text in files.items():
        if name not in present:
            faults.append(f"{directory / name}: missing")
        elif (directory / name).read_text(encoding="utf-8") != text:
            faults.append(f"{directory / name}: differs from the IDL")
    return faults


# ---- command line -------------------------------------------------------------------------------------------------

def write(path: pathlib.Path, text: str) -> None:
    """Leaves an equal file alone, so that nothing is compiled twice."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def idl_files() -> list[pathlib.Path]:
    return sorted([*IDL_DIR.glob("ros/*/*.idl"), *IDL_DIR.glob("lapis_msgs/*.idl")], key=lambda p: p.stem)


def parse_arguments(arguments) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-I", "--include", action="append", default=[], metavar="DIR",
                        help="folder to look for #include files in, before this one's packages; repeatable")
    commands = parser.add_subparsers(dest="command", required=True)

    command = commands.add_parser("list", help="print every type with its hash")
    command.add_argument("idl", nargs="*", type=pathlib.Path, help="default: all packages of this folder")
    command = commands.add_parser("schema", help="print the ros2msg schema of one type")
    command.add_argument("type", help="ROS name, as sensor_msgs/msg/Image")
    command.add_argument("idl", nargs="*", type=pathlib.Path, help="default: all packages of this folder")
    command = commands.add_parser("header", help="write idl/<package>.hpp (called by the build)")
    command.add_argument("idl", type=pathlib.Path)
    command.add_argument("--type-header", required=True, help="file of fastddsgen to include")
    command.add_argument("--output", required=True, type=pathlib.Path)
    command = commands.add_parser("table", help="write type_table.cpp (called by the build)")
    command.add_argument("idl", nargs="+", type=pathlib.Path)
    command.add_argument("--output", required=True, type=pathlib.Path)
    command = commands.add_parser("ros2-package", help="write the ROS 2 interface package of lapis_msgs")
    command.add_argument("idl", nargs="?", type=pathlib.Path, default=IDL_DIR / "lapis_msgs" / "lapis_msgs.idl")
    command.add_argument("--output", type=pathlib.Path, help="default: ros2/<package> in this folder")
    command.add_argument("--check", action="store_true", help="write nothing; fail when the files differ")
    return parser.parse_args(arguments)


def run(options: argparse.Namespace) -> int:
    library = Library([*options.include, *sorted({p.parent for p in idl_files()})])
    paths = options.idl if isinstance(options.idl, list) else [options.idl]
    structs = [struct for path in paths or idl_files() for struct in library.read(path)]
    if options.command == "list":
        for name, value in hashes(library).items():
            print(f"{name} {value}")
    elif options.command == "schema":
        if options.type not in library.structs:
            print(f"unknown type {options.type!r}; `list` prints all", file=sys.stderr)
            return 1
        print(schema(library, library.structs[options.type]), end="")
    elif options.command == "header":
        write(options.output, header_text(library, structs, options.idl.name, options.type_header))
    elif options.command == "table":
        write(options.output, table_text(library, structs))
    else:
        files = ros2_package(structs)
        directory = options.output or IDL_DIR / "ros2" / structs[0].package
        if options.check:
            faults = check_package(files, directory)
            print("".join(f + "\n" for f in faults), end="", file=sys.stderr)
            return 1 if faults else 0
        for name, text in files.items():
            write(directory / name, text)
    return 0


def main(arguments=None) -> int:
    try:
        return run(parse_arguments(arguments))
    except IdlError as error:
        print(error, file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
