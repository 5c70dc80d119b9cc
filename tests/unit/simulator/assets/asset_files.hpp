#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/scene/mesh.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::simulator::test {

using Bytes = std::vector<std::uint8_t>;
using Files = std::map<std::string, Bytes>;

Bytes to_bytes(std::string_view text);

using lapis::test::TemporaryFolder;

void write_file(const std::filesystem::path& file, const Bytes& bytes);
Bytes read_file(const std::filesystem::path& file);
/// Names that end in '/' become folders. With a password the entries are encrypted (AES-256).
void write_zip(const std::filesystem::path& file, const Files& files, const std::string& password = {});

/// A store of files that a test makes up.
class MemoryStore final : public AssetStore {
 public:
  explicit MemoryStore(Files files) : files_(std::move(files)) {}
  std::optional<Bytes> read(const std::string& name) const override;
  std::vector<std::string> names() const override;
  std::string description() const override { return "memory"; }

 private:
  Files files_;
};

/// A PNG of one colour.
Bytes png(int width, int height, Rgba8 color);

/// What the call throws; empty when it throws nothing.
template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

}  // namespace lapis::simulator::test
