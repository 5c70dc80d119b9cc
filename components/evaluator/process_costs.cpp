#include "evaluator/process_costs.hpp"

#include <charconv>

namespace lapis::evaluator {
namespace {

std::optional<double> parse(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

void ProcessCosts::add(const diagnostic_msgs::msg::DiagnosticStatus& status) {
  Costs& costs = costs_[status.hardware_id()];
  for (const auto& pair : status.values()) {
    if (pair.key() == "cpu_s") costs.cpu_s = parse(pair.value());
    if (pair.key() == "peak_rss_mb") costs.peak_rss_mb = parse(pair.value());
    if (pair.key() == "frames") costs.frames = parse(pair.value());
  }
}

void ProcessCosts::write_to(RunMetrics& metrics) const {
  for (const auto& [name, costs] : costs_) {
    metrics.peak_rss_mb[name] = costs.peak_rss_mb;
    const bool has_rate = costs.cpu_s && costs.frames && *costs.frames > 0.0;
    metrics.cpu_ms_per_frame[name] = has_rate ? std::optional(1e3 * *costs.cpu_s / *costs.frames) : std::nullopt;
  }
}

}  // namespace lapis::evaluator
