#include "tests/support/endless_process.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace lapis::test {

EndlessProcess::EndlessProcess(const std::function<bool()>& work) {
  int begun[2];
  if (::pipe(begun) != 0) std::abort();
  pid_ = ::fork();
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const char word = '!';
    if (::write(begun[1], &word, 1) != 1) ::_exit(1);
    while (work()) {
    }
    ::_exit(1);
  }
  char word = 0;
  if (pid_ < 0 || ::read(begun[0], &word, 1) != 1) std::abort();
  ::close(begun[0]);
  ::close(begun[1]);
}

bool EndlessProcess::kill() {
  if (pid_ < 0) return false;
  int status = 0;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

}  // namespace lapis::test
