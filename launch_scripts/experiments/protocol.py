"""Protocols of experiments: what experiment.sh runs, and which runs they are."""

import collections
import hashlib
import pathlib
import re

import yaml

from sources import REPOSITORY

Run = collections.namedtuple("Run", "scene duration_s label seed key arguments")


def run_id(run):
    """As rows have it."""
    return f"{run.key}/{run.scene}/{run.label}/{run.seed}"


KEYS = {"name", "title", "world", "buildings", "seeds", "methods", "settings", "failed_below", "figures", "tests",
        "conditions"}
OF_LISTS = {"buildings": ({"names", "duration_s"}, set()),
            "tests": ({"figure", "method", "against"}, {"ratio", "difference", "deviation"}),
            "conditions": ({"figure", "method", "against", "least_ratio"}, set())}
OF_KINDS = {"buildings": list, "seeds": list, "settings": dict, "failed_below": dict, "figures": list, "tests": list,
            "conditions": list}
OF_METHODS = {"method", "then", "settings"}


class ProtocolError(Exception):
    """One line that names the file, the key and the remedy."""


def read_protocol(file):
    """The protocol with all its keys; what is missing has its default."""
    try:
        content = yaml.safe_load(pathlib.Path(file).read_text(encoding="utf-8"))
    except (OSError, yaml.YAMLError) as problem:
        raise ProtocolError(f"{file}: {problem}") from problem
    if not isinstance(content, dict):
        raise ProtocolError(f"{file}: no mapping of keys to values")
    protocol = {"title": "", "world": None, "seeds": [1], "settings": {}, "failed_below": {}, "tests": [],
                "conditions": []} | content
    problem = problem_of(protocol)
    if problem:
        raise ProtocolError(f"{file}: {problem}")
    return protocol


def problem_of(protocol):
    """What is wrong with a protocol; None if nothing is."""
    if unknown := set(protocol) - KEYS:
        return f"no such key: {min(unknown)}"
    if missing := KEYS - set(protocol):
        return f"{min(missing)} is missing"
    if not re.fullmatch(r"[a-z0-9_]+", str(protocol["name"])):
        return "name: wanted are small letters, digits and _"
    for name, kind in OF_KINDS.items():
        if not isinstance(protocol[name], kind):
            return f"{name}: wanted is a {'list' if kind is list else 'mapping of keys to values'}"
    if not isinstance(protocol["methods"], dict) or not protocol["methods"]:
        return "methods: wanted are labels with {method: ...}"
    for label, method in protocol["methods"].items():
        if not isinstance(method, dict) or "method" not in method or set(method) - OF_METHODS or re.search(r"[/,]", label):
            return f"methods.{label}: wanted is {{method: ..., then: ..., settings: {{KEY: VALUE}}}}"
    for name, (needed, possible) in OF_LISTS.items():
        for i, entry in enumerate(protocol[name]):
            if not isinstance(entry, dict) or needed - set(entry) or set(entry) - needed - possible:
                return f"{name}[{i}]: wanted are {', '.join(sorted(needed))}" + (
                    f"; possible {', '.join(sorted(possible))}" if possible else "")
            if "duration_s" in entry and not (isinstance(entry["duration_s"], (int, float)) and entry["duration_s"] > 0):
                return f"{name}[{i}].duration_s: wanted is a number above 0"
            for role in {"method", "against"} & set(entry):
                if entry[role] not in protocol["methods"]:
                    return f"{name}[{i}]: {role} {entry[role]} is not among the methods"
    return None


def scenes_of(names):
    """flat_[1-3] written out."""
    match = re.fullmatch(r"(.*)\[(\d+)-(\d+)\](.*)", str(names))
    if not match:
        return [str(names)]
    before, first, last, after = match.groups()
    return [f"{before}{number}{after}" for number in range(int(first), int(last) + 1)]


def world_file(protocol):
    if not protocol["world"]:
        return None
    file = REPOSITORY / "config" / "worlds" / f"{protocol['world']}.yaml"
    if not file.is_file():
        raise ProtocolError(f"world: no file {file}")
    return file


def setting_of(key, value):
    """As --set has it."""
    return f"{key}={str(value).lower() if isinstance(value, bool) else value}"


def arguments_of(protocol, building, method):
    """Of explore.sh, but for scene, seed and folder."""
    arguments = ["--method", method["method"], "--duration", str(building["duration_s"])]
    if "then" in method:
        arguments += ["--then", method["then"]]
    if world := world_file(protocol):
        arguments += ["--world", str(world)]
    for key, value in (protocol["settings"] | method.get("settings", {})).items():
        arguments += ["--set", setting_of(key, value)]
    return arguments


def runs_of(protocol, sources):
    """In the order in which they are made: all methods of a building before the next."""
    runs = []
    for building in protocol["buildings"]:
        for scene in scenes_of(building["names"]):
            for seed in protocol["seeds"]:
                for label, method in protocol["methods"].items():
                    arguments = arguments_of(protocol, building, method)
                    files = sorted((REPOSITORY / "config" / "methods" / method["method"]).glob("*.yaml"))
                    files += [world_file(protocol)] if protocol["world"] else []
                    content = b"\0".join(file.read_bytes() for file in files)
                    words = [word.replace(str(REPOSITORY), "") for word in arguments]
                    key = hashlib.sha256("\0".join([sources, *words]).encode() + content).hexdigest()[:16]
                    runs.append(Run(scene, float(building["duration_s"]), label, str(seed), key, arguments))
    return runs
