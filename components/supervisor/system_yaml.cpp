#include "supervisor/system_yaml.hpp"

#include <yaml-cpp/yaml.h>

#include <functional>

#include "supervisor/program.hpp"

namespace lapis::supervisor {
namespace {

using Reader = std::function<void(const YAML::Node&)>;

[[noreturn]] void reject(const YAML::Node& node, const std::string& problem) {
  throw BadSetup("line " + std::to_string(node.Mark().line + 1) + ": " + problem);
}

std::string text(const YAML::Node& node) {
  if (!node.IsScalar()) reject(node, "text is needed");
  return node.Scalar();
}

std::vector<std::string> texts(const YAML::Node& node) {
  if (!node.IsSequence()) reject(node, "a list such as [a, b] is needed");
  std::vector<std::string> out;
  for (const auto& item : node) out.push_back(text(item));
  return out;
}

/// Calls `read` with name and value of each entry of a section.
void for_each(const YAML::Node& node, const std::function<void(const std::string&, const YAML::Node&)>& read) {
  if (!node.IsMap()) reject(node, "a section with keys is needed");
  for (const auto& item : node) read(item.first.Scalar(), item.second);
}

void read_section(const YAML::Node& node, const std::map<std::string, Reader>& readers) {
  for_each(node, [&](const std::string& key, const YAML::Node& value) {
    const auto reader = readers.find(key);
    if (reader == readers.end()) {
      std::string known;
      for (const auto& [name, read] : readers) known += " " + name;
      reject(value, "unknown key " + key + "; known are" + known);
    }
    reader->second(value);
  });
}

Settings settings(const YAML::Node& node) {
  Settings out;
  for_each(node, [&](const std::string& key, const YAML::Node& value) {
    if (value.IsScalar()) {
      out.push_back({key, value.Scalar()});
    } else {
      YAML::Emitter flow;
      flow << YAML::Flow << value;
      out.push_back({key, flow.c_str()});
    }
  });
  return out;
}

Resume resume(const YAML::Node& node) {
  Resume out;
  read_section(node, {{"file", [&](const auto& n) { out.file = text(n); }},
                      {"settings", [&](const auto& n) { out.settings = settings(n); }}});
  return out;
}

Variant variant(const YAML::Node& node) {
  Variant out;
  read_section(node, {{"silence_s", [&](const auto& n) { out.silence = text(n); }},
                      {"settings", [&](const auto& n) { out.settings = settings(n); }},
                      {"processes", [&](const auto& n) { out.processes = texts(n); }},
                      {"stages", [&](const auto& n) { out.stages = texts(n); }},
                      {"adds", [&](const auto& n) { out.adds = texts(n); }}});
  return out;
}

RestartPolicy restart_policy(const YAML::Node& node) {
  RestartPolicy out;
  read_section(node, {{"times", [&](const auto& n) { out.times = n.template as<int>(); }},
                      {"settings", [&](const auto& n) { out.settings = settings(n); }},
                      {"resume", [&](const auto& n) {
                         for_each(n, [&](const auto& name, const auto& ways) {
                           if (!ways.IsSequence()) reject(ways, "give a list of files with settings");
                           for (const auto& way : ways) out.resume[name].push_back(resume(way));
                         });
                       }}});
  return out;
}

/// Values of a file override those of its base, which must not have a base itself.
void read_into(System& out, const std::filesystem::path& file, bool is_base = false) {
  const YAML::Node root = YAML::LoadFile(file.string());
  const auto folder = file.parent_path();
  if (root.IsMap() && root["base"]) {
    if (is_base) reject(root["base"], "a base has no base");
    read_into(out, folder / text(root["base"]), true);
  }
  read_section(
      root,
      {{"base", [](const auto&) {}},  // has been read above
       {"processes", [&](const auto& n) { out.processes = texts(n); }},
       {"source", [&](const auto& n) { out.source = text(n); }},
       {"stages", [&](const auto& n) { out.stages = texts(n); }},
       {"settings", [&](const auto& n) { out.settings = settings(n); }},
       {"configuration",
        [&](const auto& n) {
          for (const auto& name : texts(n)) out.configuration.push_back((folder / name).string());
        }},
       {"facts",
        [&](const auto& n) {
          for (const auto& fact : settings(n)) out.facts[fact.key] = fact.value;
        }},
       {"shows", [&](const auto& n) { out.shows = text(n); }},
       {"silence_s", [&](const auto& n) { out.silence = text(n); }},
       {"report", [&](const auto& n) { out.report = text(n); }},
       {"result", [&](const auto& n) { out.result = text(n); }},
       {"results", [&](const auto& n) { out.results = texts(n); }},
       {"variants",
        [&](const auto& n) { for_each(n, [&](const auto& name, const auto& v) { out.variants[name] = variant(v); }); }},
       {"restart", [&](const auto& n) { out.restart = restart_policy(n); }}});
}

}  // namespace

System read_system(const std::filesystem::path& file) {
  System system;
  try {
    read_into(system, file);
  } catch (const std::exception& error) {
    throw BadSetup(file.string() + ": " + error.what());
  }
  system.name = file.stem().string();
  if (const auto problem = find_problem(system)) throw BadSetup(file.string() + ": " + *problem);
  return system;
}

}  // namespace lapis::supervisor
