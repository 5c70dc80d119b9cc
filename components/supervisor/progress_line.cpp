#include "supervisor/progress_line.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <iostream>

namespace lapis::supervisor {

void ProgressLine::show(const std::string& text) {
  if (text.empty() || text == shown_) return;
  shown_ = text;
  if (isatty(STDOUT_FILENO) == 0) {
    std::cout << text << std::endl;
    return;
  }
  winsize size{};
  const bool is_known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  std::cout << "\r\033[K" << text.substr(0, is_known ? size.ws_col - 1u : std::string::npos) << std::flush;
  is_open_ = true;
}

void ProgressLine::end() {
  if (is_open_) std::cout << std::endl;
  is_open_ = false;
}

}  // namespace lapis::supervisor
