// Preloaded by a test: a file called map.lapis takes LAPIS_SLOW_DISK_S seconds to be saved.
#include <dlfcn.h>

#include <chrono>
#include <cstdlib>
#include <string_view>
#include <thread>

extern "C" int rename(const char* from, const char* to) {
  using Rename = int (*)(const char*, const char*);
  static const auto rename_in_libc = reinterpret_cast<Rename>(dlsym(RTLD_NEXT, "rename"));
  const char* seconds = std::getenv("LAPIS_SLOW_DISK_S");
  if (seconds != nullptr && std::string_view(to).ends_with("/map.lapis")) {
    std::this_thread::sleep_for(std::chrono::duration<double>(std::atof(seconds)));
  }
  return rename_in_libc(from, to);
}
