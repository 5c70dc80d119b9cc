#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "segmenter/core/tensor.hpp"

namespace lapis::segmenter {

/// A network in an ONNX file, run by OpenCV's dnn on the CPU.
class Network {
 public:
  /// @param output name of the output that run() returns; empty: the only one
  /// @throws std::runtime_error naming file, reason and remedy
  Network(const std::filesystem::path& file, const std::string& output);
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  /// Output for an input of one image. The same input gives the same bytes on the same machine.
  /// @throws std::runtime_error naming file and reason when the network cannot take an input of that shape
  Tensor run(const Tensor& input);

 private:
  struct Net;  // OpenCV stays in the .cpp file

  std::filesystem::path file_;
  std::unique_ptr<Net> net_;
};

/// Number of threads of all networks of this process.
void set_threads(int number);

}  // namespace lapis::segmenter
