#pragma once

namespace lapis::supervisor {

/// lapis_supervisor: runs a system of processes. Exit status: 0 ran to the end, 1 a process failed or no frame arrived,
/// 2 bad set-up, 128 plus the number of the signal when interrupted (130 for SIGINT, 143 for SIGTERM).
int run(int argc, char** argv);

}  // namespace lapis::supervisor
