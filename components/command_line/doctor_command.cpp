#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>
#include <memory>

#include "command_line/commands.hpp"
#include "command_line/core/checks.hpp"
#include "command_line/domain_watch.hpp"
#include "common/cdr/text.hpp"

namespace lapis::command_line {
namespace {

cdr::Value to_value(const SeenStream& stream) {
  return {{"topic", stream.topic}, {"rate_hz", stream.rate_hz}, {"messages", stream.messages}, {"lost", stream.lost}};
}

cdr::Value to_value(const Snapshot& seen, const std::vector<Finding>& findings) {
  cdr::Value value{{"domain", seen.domain},
                   {"range", seen.range},
                   {"seconds", seen.seconds},
                   {"participants", seen.participants},
                   {"nodes", seen.nodes},
                   {"streams", cdr::Value::array()},
                   {"findings", cdr::Value::array()}};
  for (const SeenCamera* camera : {&seen.color, &seen.depth}) {
    if (camera->images) value["streams"].push_back(to_value(*camera->images));
  }
  for (const Finding& finding : findings) {
    value["findings"].push_back(
        {{"fault", finding.fault}, {"topic", finding.topic}, {"problem", finding.problem}, {"remedy", finding.remedy}});
  }
  return value;
}

void print_findings(const Snapshot& seen, const std::vector<Finding>& findings) {
  std::printf("domain %d (%s), %.1f s: %zu participant(s), %zu topic(s)\n", seen.domain, seen.range.c_str(),
              seen.seconds, seen.participants, topics_of(seen.endpoints).size());
  for (const SeenCamera* camera : {&seen.color, &seen.depth}) {
    if (!camera->images) continue;
    std::printf("%s: %.1f Hz, %llu image(s)\n", camera->images->topic.c_str(), camera->images->rate_hz,
                static_cast<unsigned long long>(camera->images->messages));
  }
  for (const Finding& finding : findings) {
    std::printf("\n%s%s%s: %s\n    %s\n", finding.fault.c_str(), finding.topic.empty() ? "" : "  ",
                finding.topic.c_str(), finding.problem.c_str(), finding.remedy.c_str());
  }
  if (findings.empty()) std::printf("nothing found\n");
}

Status examine(const Settings& settings, double seconds) {
  Domain domain(settings);
  DomainWatch watch(domain);
  watch.watch(Seconds(seconds));
  const Snapshot seen = watch.snapshot();
  const std::vector<Finding> findings = findings_in(seen);
  if (settings.is_json) {
    std::cout << cdr::to_json(to_value(seen, findings)) << '\n';
  } else {
    print_findings(seen, findings);
  }
  return findings.empty() ? kDone : kRefused;
}

}  // namespace

void add_doctor(CLI::App& app, const Settings& settings, Job& job) {
  auto seconds = std::make_shared<double>(5.0);
  CLI::App* command = app.add_subcommand("doctor", "say what is missing or wrong for a run, and what to do");
  command->add_option("--seconds", *seconds, "time to look at what comes [s]")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->callback([&settings, &job, seconds] { job = [&settings, seconds] { return examine(settings, *seconds); }; });
}

}  // namespace lapis::command_line
