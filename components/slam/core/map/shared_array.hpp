#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace lapis::slam {

/// Array that never changes once it is made. Copies share it, so that a copy of the map takes milliseconds and another
/// thread may read it.
template <class Value>
class SharedArray {
 public:
  SharedArray() : SharedArray(std::vector<Value>{}) {}
  SharedArray(std::vector<Value> values) : values_(std::make_shared<const std::vector<Value>>(std::move(values))) {}

  operator const std::vector<Value>&() const { return *values_; }
  const Value& operator[](std::size_t i) const { return (*values_)[i]; }
  std::size_t size() const { return values_->size(); }
  bool empty() const { return values_->empty(); }
  auto begin() const { return values_->begin(); }
  auto end() const { return values_->end(); }

 private:
  std::shared_ptr<const std::vector<Value>> values_;
};

}  // namespace lapis::slam
