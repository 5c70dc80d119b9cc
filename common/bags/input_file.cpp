#include "common/bags/input_file.hpp"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lapis::bags {
namespace {

std::string text_of(int error) { return std::generic_category().message(error); }

}  // namespace

InputFile::InputFile(std::filesystem::path path) : path_(std::move(path)) {
  if (!std::filesystem::is_regular_file(path_)) fail("no such file");
  file_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (file_ < 0 || ::fstat(file_, &status) != 0) fail(text_of(errno));
  size_ = static_cast<std::uint64_t>(status.st_size);
}

InputFile::~InputFile() {
  if (file_ >= 0) ::close(file_);
}

std::vector<std::uint8_t> InputFile::read(std::uint64_t offset, std::uint64_t size) const {
  if (offset >= size_) return {};
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(std::min(size, size_ - offset)));
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t got = ::pread(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(text_of(errno));
    if (got == 0) bytes.resize(done);  // the file has become shorter
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

void InputFile::fail(const std::string& reason) const { throw std::runtime_error(path_.string() + ": " + reason); }

}  // namespace lapis::bags
