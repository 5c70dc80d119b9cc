#pragma once

#include "command_line/settings.hpp"

namespace lapis::command_line {

// Each adds its commands to the program; when one of them is called, it becomes the job. Settings and job outlive the
// parsing of the command line.

void add_topics(CLI::App& app, const Settings& settings, Job& job);
void add_rates(CLI::App& app, const Settings& settings, Job& job);  ///< hz and bw
void add_echo(CLI::App& app, const Settings& settings, Job& job);
void add_calls(CLI::App& app, const Settings& settings, Job& job);  ///< call and its shortcuts
void add_goal(CLI::App& app, const Settings& settings, Job& job);
void add_params(CLI::App& app, const Settings& settings, Job& job);
void add_record(CLI::App& app, const Settings& settings, Job& job);
void add_doctor(CLI::App& app, const Settings& settings, Job& job);

}  // namespace lapis::command_line
