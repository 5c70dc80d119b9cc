#include "supervisor/manifest.hpp"

#include <nlohmann/json.hpp>
#include <sstream>

#include "common/config/schema.hpp"
#include "common/runtime/version.hpp"

namespace lapis::supervisor {
namespace {

/// config::quoted and --print-config write text and numbers that are valid JSON; any other scalar (.inf) becomes text.
nlohmann::ordered_json json_of(const std::string& scalar) {
  auto value = nlohmann::ordered_json::parse(scalar, nullptr, false);
  return value.is_discarded() ? nlohmann::ordered_json(scalar) : value;
}

std::string indented(const std::string& text, const std::string& indent) {
  std::istringstream in(text);
  std::string out;
  for (std::string line; std::getline(in, line);) out += indent + line + "\n";
  return out;
}

}  // namespace

std::string to_yaml(const Manifest& manifest, const std::string& simulation) {
  std::string out = "version: " + config::quoted(std::string("lapis ") + kVersion) + "\n";
  out += "command: " + config::quoted(manifest.command) + "\nrun:\n";
  for (const auto& [name, value] : manifest.facts) {
    out.append("  ").append(name).append(": ").append(value).append("\n");
  }
  out += "exit_status:\n";
  for (const auto& process : manifest.processes) {
    out += "  " + process.name + ": " + (process.status ? std::to_string(*process.status) : "null") + "\n";
  }
  out += "restarts:\n";
  for (const auto& process : manifest.processes) {
    out += "  " + process.name + ": " + std::to_string(process.restarts) + "\n";
  }
  if (!simulation.empty()) out += "simulation:\n" + indented(simulation, "  ");
  out += "configuration:\n";
  for (const auto& process : manifest.processes) {
    out += "  " + process.name + ":\n" + indented(process.configuration, "    ");
  }
  return out;
}

std::string with_facts(const std::string& metrics, const Facts& facts) {
  auto json = nlohmann::ordered_json::parse(metrics);
  nlohmann::ordered_json run;
  for (const auto& [name, value] : facts) run[name] = json_of(value);
  json["run"] = run;
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace lapis::supervisor
