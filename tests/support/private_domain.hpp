#pragma once

#include <string>

namespace lapis::test {

/// Separates this process and the children it will start from every other DDS process, so that tests neither disturb
/// a robot nor each other. Call it first thing in main(), before any thread starts. It reserves a domain id by a lock
/// that lasts as long as the process and its children, which separates shared memory, too, and where the machine allows
/// it enters a network namespace of its own with nothing but a loopback interface. Discovery stays on that interface.
/// Returns a line that says so; throws std::runtime_error when no domain is free.
std::string enter_private_domain();

}  // namespace lapis::test
