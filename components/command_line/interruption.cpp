#include "command_line/interruption.hpp"

#include <pthread.h>

#include <csignal>
#include <utility>

namespace lapis::command_line {
namespace {

constexpr int kEndOfWatch = SIGUSR1;

sigset_t watched_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, kEndOfWatch}) sigaddset(&signals, signal);
  return signals;
}

}  // namespace

Interruption::Interruption() {
  const sigset_t signals = watched_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

Interruption::~Interruption() {
  if (!thread_.joinable()) return;
  pthread_kill(thread_.native_handle(), kEndOfWatch);
  thread_.join();
}

void Interruption::watch(std::function<void()> wake) {
  thread_ = std::thread([this, wake = std::move(wake)] {
    const sigset_t signals = watched_signals();
    int signal = 0;
    while (sigwait(&signals, &signal) == 0 && signal != kEndOfWatch) {
      has_come_ = true;
      wake();
    }
  });
}

}  // namespace lapis::command_line
