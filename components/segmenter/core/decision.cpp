#include "segmenter/core/decision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace lapis::segmenter {
namespace {

std::string text_of(const std::vector<int>& shape) {
  std::string text;
  for (const int size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text;
}

/// Index of a class in the output of a network that gives labels; nothing that a table names when it is none.
std::size_t to_index(float value) {
  const bool is_index = value >= 0.0F && value < static_cast<float>(std::numeric_limits<std::uint16_t>::max());
  return is_index ? static_cast<std::size_t>(std::lround(value)) : std::numeric_limits<std::size_t>::max();
}

/// One row of the output at a time, so that all that is needed of it stays in the cache.
class Row {
 public:
  Row(const Tensor& scores, const OutputShape& shape, Values values, const ClassTable& classes)
      : scores_(scores), shape_(shape), values_(values), classes_(classes), best_(width()), index_(width()),
        same_(width()), all_(width()) {}

  void decide(std::size_t row, Segmentation& out) {
    find_best(row);
    add_up(row);
    const std::size_t first = row * width();
    for (std::size_t x = 0; x < width(); ++x) {
      const float share = values_ == Values::kLogits ? same_[x] / all_[x] : same_[x];
      if (!std::isfinite(best_[x]) || !std::isfinite(all_[x])) {
        ++out.unusable;
        continue;
      }
      out.labels.pixels[first + x] = classes_.label_of(index_[x]);
      out.confidence.pixels[first + x] = static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(share, 0.0F, 1.0F)));
    }
  }

 private:
  std::size_t width() const { return static_cast<std::size_t>(shape_.width); }
  float value(std::size_t c, std::size_t row, std::size_t x) const {
    return scores_.values[c * shape_.class_stride + (row * width() + x) * shape_.pixel_stride];
  }

  void find_best(std::size_t row) {
    std::fill(best_.begin(), best_.end(), -std::numeric_limits<float>::infinity());
    std::fill(index_.begin(), index_.end(), 0);
    for (std::size_t c = 0; c < static_cast<std::size_t>(shape_.classes); ++c) {
      for (std::size_t x = 0; x < width(); ++x) {
        const float v = value(c, row, x);
        if (!(v > best_[x])) continue;
        best_[x] = v;
        index_[x] = c;
      }
    }
  }

  /// Probabilities of the best class's label and of all, but for a factor where they come from logits.
  void add_up(std::size_t row) {
    std::fill(same_.begin(), same_.end(), 0.0F);
    std::fill(all_.begin(), all_.end(), 0.0F);
    for (std::size_t c = 0; c < static_cast<std::size_t>(shape_.classes); ++c) {
      const std::uint16_t label = classes_.label_of(c);
      for (std::size_t x = 0; x < width(); ++x) {
        const float v = value(c, row, x);
        const float p = values_ == Values::kLogits ? std::exp(v - best_[x]) : v;
        all_[x] += p;
        if (label == classes_.label_of(index_[x])) same_[x] += p;
      }
    }
  }

  const Tensor& scores_;
  const OutputShape& shape_;
  Values values_;
  const ClassTable& classes_;
  std::vector<float> best_;         // greatest value
  std::vector<std::size_t> index_;  // of the class that has it
  std::vector<float> same_, all_;
};

}  // namespace

OutputShape output_shape(const std::vector<int>& shape, const OutputFormat& format) {
  const auto refuse = [&](const std::string& wanted) {
    throw std::runtime_error("the network's output is " + text_of(shape) + "; output.values and output.layout say " +
                             wanted);
  };
  std::vector<int> sizes = shape;
  if (format.values == Values::kLabels) {
    std::erase(sizes, 1);
    if (sizes.size() != 2) refuse("height x width labels, more than one of each");
    return {0, sizes[1], sizes[0], 0, 1};
  }
  if (sizes.size() == 4 && sizes[0] == 1) sizes.erase(sizes.begin());
  const bool is_planar = format.layout == Layout::kNchw;
  const char* wanted = is_planar ? "classes x height x width, at least two classes, of one image"
                                 : "height x width x classes, at least two classes, of one image";
  if (sizes.size() != 3) refuse(wanted);
  if (!is_planar) std::rotate(sizes.begin(), sizes.begin() + 2, sizes.end());
  if (sizes[0] < 2 || sizes[1] < 1 || sizes[2] < 1) refuse(wanted);
  const std::size_t pixels = static_cast<std::size_t>(sizes[1]) * static_cast<std::size_t>(sizes[2]);
  const auto classes = static_cast<std::size_t>(sizes[0]);
  return {sizes[0], sizes[2], sizes[1], is_planar ? pixels : 1, is_planar ? 1 : classes};
}

Segmentation decide(const Tensor& scores, const OutputFormat& format, const ClassTable& classes) {
  const OutputShape shape = output_shape(scores.shape, format);
  Segmentation out;
  out.labels = geometry::LabelImage(shape.width, shape.height);
  if (format.values == Values::kLabels) {
    std::transform(scores.values.begin(), scores.values.end(), out.labels.pixels.begin(),
                   [&](float value) { return classes.label_of(to_index(value)); });
    return out;
  }
  out.confidence = geometry::ConfidenceImage(shape.width, shape.height);
  Row row(scores, shape, format.values, classes);
  for (std::size_t y = 0; y < static_cast<std::size_t>(shape.height); ++y) row.decide(y, out);
  return out;
}

}  // namespace lapis::segmenter
