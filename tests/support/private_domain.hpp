#pragma once

#include <string>

namespace lapis::test {

/// Separates this process and the children it will start from every other DDS process, so that tests neither disturb
/// a robot nor each other. Call it first thing in main(), before any thread starts. Where the machine allows, it
/// enters a network namespace of its own with nothing but a loopback interface; elsewhere it reserves a domain id by a
/// lock that lasts as long as the process and its children. In both cases discovery stays on the loopback interface.
/// Returns a line that says which of the two it is; throws std::runtime_error when neither works.
std::string enter_private_domain();

}  // namespace lapis::test
