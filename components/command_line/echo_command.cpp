#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>

#include "command_line/commands.hpp"
#include "command_line/topic_reader.hpp"
#include "common/cdr/decode.hpp"
#include "common/cdr/text.hpp"

namespace lapis::command_line {
namespace {

struct EchoOptions {
  std::string topic;
  std::string field;
  bool is_once = false;
  bool is_full = false;
  double seconds = 0.0;  ///< 0: no end
};

void print_message(const cdr::Value& message, const EchoOptions& options, bool is_json) {
  const cdr::Value& part = options.field.empty() ? message : cdr::field_of(message, options.field);
  if (is_json) {
    std::cout << cdr::to_json(part) << '\n' << std::flush;
  } else {
    std::cout << cdr::to_yaml(part, options.is_full ? part.max_size() : cdr::kLongestList) << "---\n" << std::flush;
  }
}

Status echo(const Settings& settings, const EchoOptions& options) {
  Domain domain(settings);
  const FoundTopic topic = find_topic(domain, options.topic);
  const cdr::Layout layout = layout_of(domain, topic);
  std::size_t printed = 0, damaged = 0;
  read(domain, topic, [&](const dds::RawType::Bytes& bytes, const auto&) {
    if (options.is_once && printed > 0) return;
    cdr::Value message;
    try {
      message = cdr::decode(layout, bytes);
    } catch (const std::runtime_error& error) {
      std::cerr << "lapis: a message of " << topic.name << " is no " << topic.type << ": " << error.what() << '\n';
      ++damaged;
      return;
    }
    print_message(message, options, settings.is_json);
    ++printed;
  });
  const bool has_end = options.seconds > 0.0 || options.is_once;
  const Seconds longest(options.seconds > 0.0 ? options.seconds : settings.wait_s);
  do {
    domain.wait_until([&] { return options.is_once && printed > 0; }, longest);
  } while (!has_end && !domain.is_interrupted());
  if (printed > 0 || (damaged == 0 && domain.is_interrupted())) return kDone;
  if (damaged > 0) throw Failure(kRefused, topic.name + ": no message could be read");
  throw Failure(kTooLate, topic.name + " has a publisher, but no message came");
}

}  // namespace

void add_echo(CLI::App& app, const Settings& settings, Job& job) {
  auto options = std::make_shared<EchoOptions>();
  CLI::App* command = app.add_subcommand("echo", "print the messages of a topic");
  command->add_option("topic", options->topic, "/slam/odometry")->required();
  command->add_option("--field", options->field, "print this part alone: pose.pose.position, transforms[0]");
  command->add_flag("--once", options->is_once, "end with the first message");
  command->add_flag("--full", options->is_full, "print long lists as a whole");
  command->add_option("--seconds", options->seconds, "end after this time [s]")->check(CLI::Range(0.0, 1e6));
  command->callback([&settings, &job, options] { job = [&settings, options] { return echo(settings, *options); }; });
}

}  // namespace lapis::command_line
