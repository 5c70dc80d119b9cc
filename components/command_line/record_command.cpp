#include <CLI/CLI.hpp>

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "command_line/commands.hpp"

namespace lapis::command_line {
namespace {

/// Becomes lapis_recorder, which lies beside this program.
Status record(const Settings& settings, const std::vector<std::string>& arguments) {
  const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "lapis_recorder";
  std::vector<std::string> words{program.string()};
  if (settings.domain) words.insert(words.end(), {"--domain", std::to_string(*settings.domain)});
  if (!settings.name_space.empty()) words.insert(words.end(), {"--namespace", settings.name_space});
  for (const std::string& remap : settings.remaps) words.insert(words.end(), {"--remap", remap});
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  throw Failure(kWrongCall, program.string() + ": " + std::strerror(errno));  // NOLINT(concurrency-mt-unsafe): alone
}

}  // namespace

void add_record(CLI::App& app, const Settings& settings, Job& job) {
  CLI::App* command = app.add_subcommand("record", "record topics as a bag: lapis_recorder with all its options");
  command->fallthrough(false);  // its options are not those of lapis, not even --help
  command->set_help_flag();
  command->prefix_command();
  command->callback([&settings, &job, command] {
    job = [&settings, arguments = command->remaining()] { return record(settings, arguments); };
  });
}

}  // namespace lapis::command_line
