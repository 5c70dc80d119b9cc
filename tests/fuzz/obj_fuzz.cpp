#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "simulator/core/assets/obj.hpp"

namespace {

using Bytes = std::vector<std::uint8_t>;

// The input up to its first zero byte is the OBJ file; what follows is found under every other name.
class FuzzStore final : public lapis::simulator::AssetStore {
 public:
  explicit FuzzStore(const Bytes& input) {
    const auto end = std::find(input.begin(), input.end(), 0);
    obj_.assign(input.begin(), end);
    other_.assign(end == input.end() ? end : end + 1, input.end());
  }
  std::optional<Bytes> read(const std::string& name) const override { return name == "a.obj" ? obj_ : other_; }
  std::vector<std::string> names() const override { return {"a.obj", "a.mtl", "a.png"}; }
  std::string description() const override { return "fuzz"; }

 private:
  Bytes obj_, other_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzStore store(Bytes(data, data + size));
  try {
    const auto model = lapis::simulator::read_obj(store, "a.obj", 16);
    if (!problem_of(model.mesh).empty()) std::abort();
  } catch (const std::runtime_error&) {  // refused with a reason
  }
  return 0;
}
