// A thread that runs before main() and blocks no signal, as OpenBLAS starts them when it is loaded.
#include <unistd.h>

#include <thread>

namespace {

[[maybe_unused]] const bool is_started = [] {
  std::thread([] {
    for (;;) pause();
  }).detach();
  return true;
}();

}  // namespace
