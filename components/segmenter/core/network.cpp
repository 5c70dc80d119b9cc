#include "segmenter/core/network.hpp"

#include <algorithm>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <stdexcept>

#include "common/files/atomic_file.hpp"

namespace lapis::segmenter {
namespace {

/// What OpenCV says, or the system, in one line that can be read.
std::string reason_of(const std::exception& error) {
  constexpr std::size_t kLongest = 400;
  const auto* of_opencv = dynamic_cast<const cv::Exception*>(&error);
  std::string text = of_opencv != nullptr && !of_opencv->err.empty() ? of_opencv->err : error.what();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.substr(0, kLongest);
}

/// Name of the output, as OpenCV knows it.
std::string chosen_output(const cv::dnn::Net& net, const std::string& name, const std::filesystem::path& file) {
  auto names = net.getUnconnectedOutLayersNames();
  std::sort(names.begin(), names.end());
  std::string known;
  for (const auto& one : names) known += (known.empty() ? "" : ", ") + one;
  if (name.empty() && names.size() == 1) return names[0];
  if (std::find(names.begin(), names.end(), name) != names.end()) return name;
  const std::string problem = name.empty() ? "has several outputs: set output.name to one of "
                                           : "has no output '" + name + "' (output.name); it has ";
  throw std::runtime_error(file.string() + ": the network " + problem + known);
}

}  // namespace

struct Network::Net {
  cv::dnn::Net net;
  std::string output;
};

Network::Network(const std::filesystem::path& file, const std::string& output) : file_(file) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // what it says is in the exceptions, too
  std::string error;
  const auto bytes = files::read_file(file.string(), error);
  if (!bytes) throw std::runtime_error(error);
  try {
    net_ = std::make_unique<Net>();
    net_->net = cv::dnn::readNetFromONNX(*bytes);
    net_->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  } catch (const std::exception& problem) {
    throw std::runtime_error(file.string() + ": OpenCV " + CV_VERSION +
                             " cannot read this network; export it with another opset, or simplify it "
                             "(components/segmenter/README.md): " +
                             reason_of(problem));
  }
  net_->output = chosen_output(net_->net, output, file);
}

Network::~Network() = default;

Tensor Network::run(const Tensor& input) {
  try {
    // The const_cast is safe because setInput copies.
    const cv::Mat blob(input.shape, CV_32F, const_cast<float*>(input.values.data()));
    net_->net.setInput(blob);
    cv::Mat result = net_->net.forward(net_->output);
    if (result.type() != CV_32F) result.convertTo(result, CV_32F);  // indices of newer versions of OpenCV
    Tensor output{std::vector<int>(result.size.p, result.size.p + result.dims), {}};
    output.values.assign(result.ptr<float>(), result.ptr<float>() + result.total());
    return output;
  } catch (const std::exception& problem) {
    throw std::runtime_error(file_.string() +
                             ": the network cannot take this input; see input.width, input.height and "
                             "input.layout: " +
                             reason_of(problem));
  }
}

void set_threads(int number) { cv::setNumThreads(number); }

}  // namespace lapis::segmenter
