"""C++ of the IDL files: classes with an accessor for each member, which write themselves to CDR and read themselves."""

from __future__ import annotations

from idl_parser import Constant, Field, IdlError, Struct, Type

KEY_BYTES = 16      # an instance of a topic is known by as many; longer keys would need a digest
_NUMBERS = {"bool": "bool", "byte": "std::uint8_t", "float32": "float", "float64": "double",
            **{f"{sign}int{bits}": f"std::{sign}int{bits}_t" for sign in ("", "u") for bits in (8, 16, 32, 64)}}
_BYTES = {name: int(name[-2:]) // 8 for name in _NUMBERS if name.endswith(("16", "32", "64"))}  # others have one


def cpp_name(ros_name: str) -> str:
    return "::" + ros_name.replace("/", "::")


def _cpp_type(type_: Type) -> str:
    element = cpp_name(type_.name) if type_.is_struct else _NUMBERS.get(type_.name, "std::string")
    if type_.container == "array":
        return f"std::array<{element}, {type_.capacity}>"
    return f"std::vector<{element}>" if type_.container else element


def _is_number(type_: Type) -> bool:
    return not type_.container and type_.name in _NUMBERS


def _constant(constant: Constant) -> str:
    cpp_type = _NUMBERS.get(constant.type, "const char*")
    value = {"TRUE": "true", "FALSE": "false"}.get(constant.value, constant.value)
    return f"inline constexpr {cpp_type} {constant.name} = {value};"


def _accessors(field: Field) -> list[str]:
    name, cpp_type = field.name, _cpp_type(field.type)
    if _is_number(field.type):
        return [f"  {cpp_type} {name}() const {{ return {name}_; }}",
                f"  {cpp_type}& {name}() {{ return {name}_; }}",
                f"  void {name}({cpp_type} value) {{ {name}_ = value; }}"]
    return [f"  const {cpp_type}& {name}() const {{ return {name}_; }}",
            f"  {cpp_type}& {name}() {{ return {name}_; }}",
            f"  void {name}(const {cpp_type}& value) {{ {name}_ = value; }}",
            f"  void {name}({cpp_type}&& value) {{ {name}_ = std::move(value); }}"]


def _is_keyed(struct: Struct) -> bool:
    keys = [f.type for f in struct.fields if f.is_key]
    if not all(map(_is_number, keys)) or sum(_BYTES.get(key.name, 1) for key in keys) > KEY_BYTES:
        raise IdlError(struct.path, struct.line, f"{struct.ros_name}: keys are numbers, of {KEY_BYTES} bytes in all")
    return bool(keys)


def declarations(struct: Struct) -> list[str]:
    """The struct's constants and its class."""
    lines = [f"namespace {struct.package}::{struct.section} {{", ""]
    if struct.constants:
        lines += [f"namespace {struct.name}_Constants {{", *map(_constant, struct.constants), "}", ""]
    lines += [f"class {struct.name} {{", " public:"]
    for field in struct.fields:
        lines += _accessors(field)
    lines += [f"  bool operator==(const {struct.name}&) const = default;",
              "  void write(lapis::idl::CdrWriter& to) const;", "  void read(lapis::idl::CdrReader& from);"]
    if _is_keyed(struct):
        lines.append("  void write_key(lapis::idl::CdrWriter& to) const;")
    lines += ["", " private:", *(f"  {_cpp_type(f.type)} {f.name}_{{}};" for f in struct.fields)]
    return [*lines, "};", "", f"}}  // namespace {struct.package}::{struct.section}", ""]


def _read(field: Field) -> str:
    bound = field.type.capacity if field.type.container == "bounded" else 0
    if not field.type.container:
        bound = field.type.string_bound
    return f"  from({field.name}_, {bound});" if bound else f"  from({field.name}_);"


def definitions(struct: Struct) -> list[str]:
    """How the class writes and reads itself."""
    name = cpp_name(struct.ros_name)[2:]
    lines = [f"void {name}::write(lapis::idl::CdrWriter& to) const {{", *(f"  to({f.name}_);" for f in struct.fields),
             "}", "", f"void {name}::read(lapis::idl::CdrReader& from) {{", *map(_read, struct.fields), "}", ""]
    if _is_keyed(struct):
        lines += [f"void {name}::write_key(lapis::idl::CdrWriter& to) const {{",
                  *(f"  to({f.name}_);" for f in struct.fields if f.is_key), "}", ""]
    return lines
