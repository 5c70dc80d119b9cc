#pragma once

namespace lapis::command_line {

/// lapis: looks at a DDS domain, calls its services and checks it, without ROS. Returns the exit status (Status).
int run(int argc, char** argv);

}  // namespace lapis::command_line
