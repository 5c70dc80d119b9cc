#include "supervisor/manifest.hpp"

#include <charconv>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/config/schema.hpp"
#include "common/runtime/version.hpp"

namespace lapis::supervisor {
namespace {

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && last == end ? std::optional(value) : std::nullopt;
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
    out += "  " + name + ": " + (number_in(value) ? value : config::quoted(value)) + "\n";
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

std::string with_facts(const std::string& metrics, const std::map<std::string, std::string>& facts) {
  auto json = nlohmann::ordered_json::parse(metrics);
  nlohmann::ordered_json run;
  for (const auto& [name, value] : facts) {
    std::int64_t whole = 0;
    const char* end = value.data() + value.size();
    const auto [last, error] = std::from_chars(value.data(), end, whole);
    if (error == std::errc() && last == end) {
      run[name] = whole;
    } else if (const auto number = number_in(value)) {
      run[name] = *number;
    } else {
      run[name] = value;
    }
  }
  json["run"] = run;
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace lapis::supervisor
