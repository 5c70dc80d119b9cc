#pragma once

namespace lapis::supervisor {

/// lapis_supervisor: runs a system of processes. Exit status: 0 ran to the end, 1 a process failed or no frame came,
/// 2 bad set-up, 130 and 143 interrupted.
int run(int argc, char** argv);

}  // namespace lapis::supervisor
