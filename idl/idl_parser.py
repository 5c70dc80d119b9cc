"""Parser of the IDL subset that this folder uses; python3 standard library only.

Accepted: #include "x.idl", include guards, module, struct, const, @key, the primitive types below, string, string<N>,
sequence<T>, sequence<T, N>, T name[N], comments. One file holds one package:

    module <package> { module msg | srv | action { module <Struct>_Constants { const ...; }; struct <Struct> { ...; }; }; };

Everything else is an IdlError that names file and line. The parser is stricter than fastddsgen on purpose: what it
accepts has one meaning in DDS, in ROS 2 .msg files and in type hashes.
"""

from __future__ import annotations

import dataclasses
import pathlib
import re

# IDL spelling -> ROS 2 spelling. `octet` is ROS's `byte`, which type hashes distinguish from `uint8`.
PRIMITIVES = {
    "boolean": "bool", "octet": "byte", "float": "float32", "double": "float64",
    "int8": "int8", "uint8": "uint8", "int16": "int16", "uint16": "uint16",
    "int32": "int32", "uint32": "uint32", "int64": "int64", "uint64": "uint64",
}
# IDL has no empty struct; ROS 2 puts one byte of this name on the wire.
EMPTY_MEMBER = "structure_needs_at_least_one_member"
# Structs of an action: those that an .action file declares, and those that ROS 2 derives from them.
ACTION_PARTS = {
    "Goal": None, "Result": None, "Feedback": None,
    "SendGoal_Request": "unique_identifier_msgs/msg/UUID goal_id, {}_Goal goal",
    "SendGoal_Response": "bool accepted, builtin_interfaces/msg/Time stamp",
    "GetResult_Request": "unique_identifier_msgs/msg/UUID goal_id",
    "GetResult_Response": "int8 status, {}_Result result",
    "FeedbackMessage": "unique_identifier_msgs/msg/UUID goal_id, {}_Feedback feedback",
}

_TOKEN = re.compile(r"""
    (?P<space>[ \t\r]+) | (?P<newline>\n)
  | (?P<line_comment>//[^\n]*) | (?P<block_comment>/\*.*?\*/)
  | (?P<directive>\#[^\n]*)
  | (?P<string>"[^"\n]*")
  | (?P<number>-?(?:0[xX][0-9a-fA-F]+|\d+(?:\.\d+)?(?:[eE][-+]?\d+)?))
  | (?P<name>[A-Za-z_][A-Za-z0-9_]*) | (?P<symbol>::|[{}\[\]<>;,=@])
""", re.VERBOSE | re.DOTALL)
_INCLUDE = re.compile(r'#\s*include\s+"([^"]+)"\s*$')
_GUARD = re.compile(r"#\s*(ifndef|define)\s+([A-Z_][A-Z0-9_]*)\s*$")
_FIELD_NAME = re.compile(r"[a-z](?:_?[a-z0-9])*$")
_STRUCT_NAME = re.compile(r"[A-Z][A-Za-z0-9]*$")
_INTEGER = re.compile(r"(?:-?(?:0|[1-9]\d*)|0[xX][0-9a-fA-F]+)$")
_CONSTANT_NAME = re.compile(r"[A-Z](?:_?[A-Z0-9])*$")


def _integer_range(type_name: str) -> range:
    bits = 8 if type_name == "octet" else int(type_name.lstrip("uint"))
    return range(-2 ** (bits - 1), 2 ** (bits - 1)) if type_name.startswith("int") else range(2 ** bits)


class IdlError(Exception):
    """A fault of an IDL file: `path:line: message`."""

    def __init__(self, path, line: int, message: str):
        super().__init__(f"{path}:{line}: {message}")


@dataclasses.dataclass(frozen=True)
class Type:
    """Type of a member. `name` is ROS spelling: a primitive, "string" or "package/msg/Name"."""
    name: str
    string_bound: int = 0       # of string<N>; 0 = unbounded
    container: str = ""         # "", "array", "bounded" or "unbounded" sequence
    capacity: int = 0           # array size or sequence bound

    @property
    def is_struct(self) -> bool:
        return "/" in self.name


@dataclasses.dataclass(frozen=True)
class Constant:
    type: str                   # ROS spelling
    name: str
    value: str
    comments: tuple[str, ...] = ()
    comment_after: str = ""


@dataclasses.dataclass(frozen=True)
class Field:
    type: Type
    name: str
    is_key: bool = False
    comments: tuple[str, ...] = ()      # lines above
    comment_after: str = ""             # on the same line


@dataclasses.dataclass(frozen=True)
class Struct:
    package: str
    section: str                # "msg", "srv" or "action"
    name: str
    fields: tuple[Field, ...]
    constants: tuple[Constant, ...]
    comments: tuple[str, ...]
    path: pathlib.Path
    line: int

    @property
    def ros_name(self) -> str:
        return f"{self.package}/{self.section}/{self.name}"

    @property
    def is_empty(self) -> bool:
        return len(self.fields) == 1 and self.fields[0].name == EMPTY_MEMBER


@dataclasses.dataclass(frozen=True)
class _Token:
    kind: str
    text: str
    line: int
    comments: tuple[str, ...]   # full-line comments above


class Library:
    """All structs of the files read so far, by ROS name; each file is read once."""

    def __init__(self, include_dirs):
        self.include_dirs = [pathlib.Path(d) for d in include_dirs]
        self.structs: dict[str, Struct] = {}
        self._files: dict[pathlib.Path, bool] = {}      # path -> read to its end

    def read(self, path) -> list[Struct]:
        """Reads a file and what it includes; returns the structs declared in the file itself, in order."""
        path = pathlib.Path(path)
        key = path.resolve()
        if key not in self._files:
            try:
                text = path.read_text(encoding="utf-8")
            except (OSError, UnicodeDecodeError) as error:
                raise IdlError(path, 1, f"cannot be read: {error}") from None
            self._files[key] = False
            _Parser(self, path, text).parse()
            self._files[key] = True
        return [s for s in self.structs.values() if s.path.resolve() == key]

    def include(self, name: str, path: pathlib.Path, line: int) -> None:
        for directory in [path.parent, *self.include_dirs]:
            found = directory / name
            if found.is_file():
                if self._files.get(found.resolve()) is False:
                    raise IdlError(path, line, f'#include "{name}" is circular')
                self.read(found)
                return
        raise IdlError(path, line, f'#include "{name}": no such file beside it or in the include folders')


class _Parser:
    def __init__(self, library: Library, path: pathlib.Path, text: str):
        self.library = library
        self.path = path
        self.comments_after: dict[int, str] = {}
        self.last_line = max(1, len(text.splitlines()))
        self.included: set[str] = set()     # packages whose types may be named here
        self.tokens = self._tokenize(text)
        self.position = 0

    def fail(self, message: str, line: int | None = None):
        if line is None:
            line = self.peek().line if self.peek() else self.last_line
        raise IdlError(self.path, line, message)

    # ---- characters -> tokens -------------------------------------------------------------------------------

    def _tokenize(self, text: str) -> list[_Token]:
        tokens: list[_Token] = []
        comments: list[str] = []
        position, line, last_code_line = 0, 1, 0
        line_is_blank = True
        while position < len(text):
            match = _TOKEN.match(text, position)
            if not match:
                self.fail(f"unexpected {text[position]!r}", line)
            kind, token = match.lastgroup, match.group()
            if kind == "newline":
                if line_is_blank:
                    comments = []       # a blank line ends a comment block
                line_is_blank = True
            elif kind != "space":
                line_is_blank = False
            if kind == "line_comment":
                comment = token[2:].strip()
                if line == last_code_line:
                    self.comments_after[line] = comment
                else:
                    comments.append(comment)
            elif kind not in ("space", "newline", "block_comment"):
                tokens.append(_Token(kind, token, line, tuple(comments)))
                comments, last_code_line = [], line
            line += token.count("\n")
            position = match.end()
        return tokens

    def peek(self) -> _Token | None:
        return self.tokens[self.position] if self.position < len(self.tokens) else None

    def next(self, expected: str) -> _Token:
        token = self.peek()
        if token is None:
            self.fail(f"end of file, expected {expected}")
        self.position += 1
        return token

    def take(self, text: str) -> _Token:
        token = self.next(repr(text))
        if token.text != text:
            self.fail(f"expected {text!r}, found {token.text!r}", token.line)
        return token

    def take_kind(self, kind: str) -> _Token:
        token = self.next(f"a {kind}")
        if token.kind != kind:
            self.fail(f"expected a {kind}, found {token.text!r}", token.line)
        return token

    def at(self, text: str) -> bool:
        token = self.peek()
        return token is not None and token.text == text

    def take_count(self) -> int:
        token = self.take_kind("number")
        if not token.text.isdigit() or int(token.text) == 0:
            self.fail(f"expected a size of at least 1, found {token.text!r}", token.line)
        return int(token.text)

    # ---- tokens -> structs ----------------------------------------------------------------------------------

    def parse(self) -> None:
        guard = self._take_guard()
        while self.peek() and self.peek().kind == "directive" and _INCLUDE.match(self.peek().text):
            token = self.next("#include")
            name = _INCLUDE.match(token.text).group(1)
            self.library.include(name, self.path, token.line)
            self.included.add(pathlib.Path(name).stem)
        self._package()
        if guard:
            token = self.next("#endif")
            if token.text.split() != ["#endif"]:
                self.fail(f"expected #endif, found {token.text!r}", token.line)
        if self.peek():
            self.fail(f"expected the end of the file, found {self.peek().text!r}")

    def _take_guard(self) -> bool:
        if not (self.peek() and self.peek().text.startswith("#ifndef")):
            return False
        first, second = self.next("#ifndef"), self.next("#define")
        matches = [_GUARD.match(first.text), _GUARD.match(second.text)]
        if not all(matches) or [m.group(1) for m in matches] != ["ifndef", "define"] \
                or matches[0].group(2) != matches[1].group(2):
            self.fail("an include guard is #ifndef NAME and #define NAME", first.line)
        return True

    def _package(self) -> None:
        self.take("module")
        token = self.take_kind("name")
        if token.text != self.path.stem:
            self.fail(f"package {token.text!r} must live in {token.text}.idl", token.line)
        self.package = token.text
        self.included.add(self.package)
        self.take("{")
        while not self.at("}"):
            self.take("module")
            section = self.take_kind("name")
            if section.text not in ("msg", "srv", "action"):
                self.fail(f"expected module msg, srv or action, found {section.text!r}", section.line)
            self.section = section.text
            self._section()
        self._close()

    def _close(self) -> None:
        self.take("}")
        self.take(";")

    def _section(self) -> None:
        self.take("{")
        pending: dict[str, tuple[Constant, ...]] = {}
        pending_comments: tuple[str, ...] = ()
        line = self.peek().line if self.peek() else self.last_line
        while not self.at("}"):
            token = self.next("struct or module")
            line = token.line
            if token.text == "module":
                name = self.take_kind("name").text
                if not name.endswith("_Constants"):
                    self.fail(f"constants of struct X live in module X_Constants, found {name!r}", line)
                owner = name.removesuffix("_Constants")
                if owner in pending:
                    self.fail(f"constants of {owner} are declared twice", line)
                pending[owner] = self._constants()
                pending_comments = token.comments
            elif token.text == "struct":
                self._struct(token, pending, pending_comments)
                pending_comments = ()
            else:
                self.fail(f"expected struct or module, found {token.text!r}", line)
        if pending:
            self.fail(f"no struct {next(iter(pending))} follows its constants", line)
        self._close()
        if self.section == "srv":
            self._check_services(line)
        elif self.section == "action":
            self._check_actions(line)

    def _check_services(self, line: int) -> None:
        names = {s.name for s in self.library.structs.values() if (s.package, s.section) == (self.package, "srv")}
        for name in sorted(names):
            base, _, part = name.rpartition("_")
            other = f"{base}_{'Response' if part == 'Request' else 'Request'}"
            if other not in names:
                self.fail(f"{name} has no {other}", line)

    def _check_actions(self, line: int) -> None:
        structs = {s.name: s for s in self.library.structs.values()
                   if (s.package, s.section) == (self.package, "action")}
        for action in sorted({name.partition("_")[0] for name in structs}):
            for part, members in ACTION_PARTS.items():
                struct = structs.get(f"{action}_{part}")
                if struct is None:
                    self.fail(f"action {action} has no {action}_{part}", line)
                found = ", ".join(f"{f.type.name} {f.name}" for f in struct.fields)
                wanted = (members or "").format(f"{self.package}/action/{action}")
                if members and found != wanted:
                    self.fail(f"{struct.name} has {found}; ROS 2 gives it {wanted}", struct.line)

    def _constants(self) -> tuple[Constant, ...]:
        constants: list[Constant] = []
        self.take("{")
        while not self.at("}"):
            start = self.take("const")
            type_token = self.take_kind("name")
            if type_token.text not in PRIMITIVES and type_token.text != "string":
                self.fail(f"a constant cannot be of type {type_token.text!r}", type_token.line)
            name = self.take_kind("name")
            if not _CONSTANT_NAME.match(name.text) or any(c.name == name.text for c in constants):
                self.fail(f"constant {name.text!r} is declared twice or not UPPER_CASE", name.line)
            self.take("=")
            value = self._constant_value(type_token.text)
            end = self.take(";")
            constants.append(Constant(PRIMITIVES.get(type_token.text, "string"), name.text, value, start.comments,
                                      self.comments_after.get(end.line, "")))
        self._close()
        return tuple(constants)

    def _constant_value(self, type_name: str) -> str:
        token = self.next("a value")
        if type_name == "string":
            good = token.kind == "string"
        elif type_name == "boolean":
            good = token.text in ("TRUE", "FALSE")
        elif type_name in ("float", "double"):
            good = token.kind == "number"
        else:
            good = _INTEGER.match(token.text) and int(token.text, 0) in _integer_range(type_name)
        if not good:
            self.fail(f"{token.text!r} is not a value of type {type_name}", token.line)
        return token.text

    def _struct(self, start: _Token, pending: dict, pending_comments: tuple[str, ...]) -> None:
        name = self.take_kind("name")
        base = name.text
        if self.section == "srv":
            base, _, part = name.text.rpartition("_")
            if part not in ("Request", "Response"):
                self.fail(f"a struct of module srv ends in _Request or _Response, found {name.text!r}", name.line)
        elif self.section == "action":
            base, _, part = name.text.partition("_")
            if part not in ACTION_PARTS:
                self.fail(f"a struct of module action is none of _{', _'.join(ACTION_PARTS)}: {name.text!r}", name.line)
        if not _STRUCT_NAME.match(base):
            self.fail(f"struct {name.text!r} is not in CamelCase", name.line)
        ros_name = f"{self.package}/{self.section}/{name.text}"
        if ros_name in self.library.structs:
            self.fail(f"struct {ros_name} is declared twice", name.line)
        self.take("{")
        fields: list[Field] = []
        while not self.at("}"):
            field = self._field()
            if any(f.name == field.name for f in fields):
                self.fail(f"{ros_name} has two members {field.name!r}", self.tokens[self.position - 1].line)
            fields.append(field)
        self._close()
        if not fields:
            self.fail(f"{ros_name} is empty: give it `uint8 {EMPTY_MEMBER};`", name.line)
        self.library.structs[ros_name] = Struct(
            self.package, self.section, name.text, tuple(fields), pending.pop(name.text, ()),
            pending_comments + start.comments, self.path, name.line)

    def _field(self) -> Field:
        comments = self.peek().comments if self.peek() else ()
        is_key = self.at("@")
        if is_key:
            self.take("@")
            self.take("key")
        type_ = self._type()
        name = self.take_kind("name")
        text = name.text.removeprefix("_")      # IDL's escape of a keyword, as in `_map`
        if not _FIELD_NAME.match(text):
            self.fail(f"member {name.text!r} is not in snake_case", name.line)
        if self.at("["):
            if type_.container:
                self.fail("an array of sequences is not part of the subset", name.line)
            self.take("[")
            type_ = dataclasses.replace(type_, container="array", capacity=self.take_count())
            self.take("]")
        end = self.take(";")
        return Field(type_, text, is_key, comments, self.comments_after.get(end.line, ""))

    def _type(self) -> Type:
        token = self.take_kind("name")
        if token.text == "sequence":
            self.take("<")
            element = self._type()
            if element.container:
                self.fail("a sequence of sequences is not part of the subset", token.line)
            capacity = 0
            if self.at(","):
                self.take(",")
                capacity = self.take_count()
            self.take(">")
            return dataclasses.replace(element, container="bounded" if capacity else "unbounded", capacity=capacity)
        if token.text == "string":
            bound = 0
            if self.at("<"):
                self.take("<")
                bound = self.take_count()
                self.take(">")
            return Type("string", string_bound=bound)
        if token.text in PRIMITIVES:
            return Type(PRIMITIVES[token.text])
        return Type(self._struct_name(token))

    def _struct_name(self, token: _Token) -> str:
        parts = [token.text]
        while self.at("::"):
            self.take("::")
            parts.append(self.take_kind("name").text)
        if len(parts) == 1:
            parts = [self.package, self.section, *parts]
        name = "/".join(parts)
        if len(parts) != 3 or parts[0] not in self.included or name not in self.library.structs:
            self.fail(f"unknown type {'::'.join(parts)!r}: declare or #include it first", token.line)
        return name
