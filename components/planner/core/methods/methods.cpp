#include "planner/core/methods/methods.hpp"

#include <algorithm>
#include <iterator>

#include "planner/core/methods/dopt_only.hpp"
#include "planner/core/methods/fixed_n.hpp"
#include "planner/core/methods/mi_only.hpp"
#include "planner/core/methods/nearest.hpp"
#include "planner/core/methods/paper.hpp"
#include "planner/core/methods/placed.hpp"
#include "planner/core/methods/ssmi.hpp"

namespace lapis::planner {
namespace {

using Maker = std::shared_ptr<const Method> (*)(const MethodsConfig&);

struct Entry {
  const char* name;
  Maker make;
};

template <class M>
std::shared_ptr<const Method> make(const MethodsConfig&) {
  return std::make_shared<M>();
}

/// All methods. A new method needs one line here.
constexpr Entry kMethods[] = {
    {"paper", make<Paper>},
    {"fixed_n", make<FixedN>},
    {"joint", [](const MethodsConfig& c) -> std::shared_ptr<const Method> { return std::make_shared<Joint>(c.joint); }},
    {"ssmi", make<Ssmi>},
    {"tare", [](const MethodsConfig& c) -> std::shared_ptr<const Method> { return std::make_shared<Tare>(c.tare); }},
    {"nearest", make<Nearest>},
    {"mi_only", make<MiOnly>},
    {"dopt_only", make<DoptOnly>},
    {"placed", make<Placed>},
};

constexpr const char* kLapis = "joint";  // docs/decisions/0031-the-method-called-lapis.md

}  // namespace

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Entry& entry : kMethods) all.emplace_back(entry.name);
    return all;
  }();
  return names;
}

std::shared_ptr<const Method> make_method(const std::string& name, const MethodsConfig& config) {
  const std::string wanted = name == "lapis" ? kLapis : name;
  const auto found =
      std::find_if(std::begin(kMethods), std::end(kMethods), [&](const Entry& entry) { return entry.name == wanted; });
  return found == std::end(kMethods) ? nullptr : found->make(config);
}

}  // namespace lapis::planner
