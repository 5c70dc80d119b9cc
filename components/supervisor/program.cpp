#include "supervisor/program.hpp"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <array>
#include <csignal>

#include "common/config/schema.hpp"
#include "common/config/yaml.hpp"

namespace lapis::supervisor {
namespace {

/// A file in memory for the output of a program.
class Paper {
 public:
  Paper() : file_(memfd_create("printed", MFD_CLOEXEC)) {}
  ~Paper() { close(file_); }
  Paper(const Paper&) = delete;
  Paper& operator=(const Paper&) = delete;

  int file() const { return file_; }
  std::string text() const {
    std::string out;
    std::array<char, 4096> buffer{};
    off_t offset = 0;
    for (ssize_t n = 0; (n = pread(file_, buffer.data(), buffer.size(), offset)) > 0; offset += n) {
      out.append(buffer.data(), static_cast<std::size_t>(n));
    }
    return out;
  }

 private:
  int file_;
};

/// Runs a program and returns its exit status; nothing when it cannot be started.
std::optional<int> run(const std::filesystem::path& program, std::vector<std::string>& arguments, const Paper& out,
                       const Paper& err) {
  std::string name = program.string();
  std::vector<char*> pointers{name.data()};
  for (auto& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, out.file(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.file(), STDERR_FILENO);
  pid_t child = 0;
  const int failure = posix_spawn(&child, name.c_str(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (failure != 0 || waitpid(child, &status, 0) != child) return std::nullopt;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

constexpr const char* kTextTag = "!";  // tag of a scalar in quotes

std::string value_text(const YAML::Node& node) {
  if (node.IsScalar()) return node.Tag() == kTextTag ? config::quoted(node.Scalar()) : node.Scalar();
  YAML::Emitter out;
  out << YAML::Flow << node;
  return out.c_str();
}

void flatten(const YAML::Node& node, const std::string& prefix, Configuration& values) {
  for (const auto& item : node) {
    const std::string key = prefix + item.first.Scalar();
    if (item.second.IsMap()) {
      flatten(item.second, key + ".", values);
    } else {
      values[key] = value_text(item.second);
    }
  }
}

}  // namespace

PrintedConfiguration print_configuration(const std::filesystem::path& program, std::vector<std::string> arguments) {
  const Paper out;
  const Paper err;
  arguments.emplace_back("--print-config");
  const auto status = run(program, arguments, out, err);
  if (!status) throw BadSetup("no program " + program.string() + "; launch_scripts/setup.sh builds it");
  if (*status != 0) {
    std::string reason = err.text();
    while (!reason.empty() && reason.back() == '\n') reason.pop_back();
    throw BadSetup(!reason.empty() ? reason
                                   : program.string() + " --print-config ended with status " + std::to_string(*status));
  }
  PrintedConfiguration printed{out.text(), {}};
  flatten(YAML::Load(printed.text), "", printed.values);
  return printed;
}

std::vector<std::string> sections_of(const std::filesystem::path& file) {
  std::vector<std::string> sections;
  try {
    for (const auto& item : YAML::Load(config::read_text(file.string()))) sections.push_back(item.first.Scalar());
  } catch (const config::Error& error) {
    throw BadSetup(error.what());
  } catch (const YAML::Exception& error) {
    throw BadSetup(file.string() + ": " + error.what() + "; wanted is a configuration file");
  }
  return sections;
}

}  // namespace lapis::supervisor
