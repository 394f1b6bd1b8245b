#include "detection/network.h"

#include <filesystem>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <utility>

namespace vismap {
namespace {

/// The message of an exception of OpenCV in one line, without positions in its source files.
std::string OneLine(const cv::Exception& exception) {
  std::string text = exception.err.empty() ? exception.msg : exception.err;
  for (char& c : text) c = c == '\n' || c == '\r' ? ' ' : c;
  const size_t last = text.find_last_not_of(' ');
  return text.substr(0, std::min<size_t>(last == std::string::npos ? 0 : last + 1, 300));
}

/// Runs `action`, and turns exceptions of OpenCV and of the libraries below it into errors.
template <typename Action>
Result<void> CatchExceptions(const std::string& what, const Action& action) {
  try {
    action();
    return {};
  } catch (const cv::Exception& exception) {
    return Fail(what + ": OpenCV says: " + OneLine(exception));
  } catch (const std::exception& exception) {
    return Fail(what + ": " + exception.what());
  }
}

// The largest file of a network: the formats are protobuf, which ends there [bytes].
constexpr uintmax_t kMaxFileBytes = (uintmax_t{1} << 31) - 1;

Result<void> CheckFile(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return Fail(path + ": no such file; expected a network");
  const uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error || bytes <= kMaxFileBytes) return {};
  return Fail(path + ": expected a network of at most " + std::to_string(kMaxFileBytes) +
              " bytes, found " + std::to_string(bytes));
}

Tensor FromMat(const cv::Mat& mat) {
  Tensor tensor;
  tensor.shape.assign(mat.size.p, mat.size.p + mat.dims);
  const cv::Mat dense = mat.isContinuous() ? mat : mat.clone();
  const float* values = dense.ptr<float>();
  tensor.values.assign(values, values + dense.total());
  return tensor;
}

}  // namespace

struct Network::Net {
  cv::dnn::Net net;

  /// Fails unless the network has layers of all these names.
  Result<void> CheckNames(const std::vector<std::string>& names) const {
    for (const std::string& name : names) {
      if (net.getLayerId(name) >= 0) continue;
      std::string found;
      for (const cv::String& output : net.getUnconnectedOutLayersNames())
        found += (found.empty() ? "" : ", ") + output;
      return Fail("expected an output " + name + ", found " + (found.empty() ? "none" : found));
    }
    return {};
  }
};

Network::Network(std::unique_ptr<Net> net) : net_(std::move(net)) {}
Network::~Network() = default;
Network::Network(Network&&) noexcept = default;
Network& Network::operator=(Network&&) noexcept = default;

Result<Network> Network::Load(const std::string& model, const std::string& graph, int threads) {
  // Our libraries do not log. OpenCV reports its errors as exceptions, too.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  if (const auto there = CheckFile(model); !there) return tl::unexpected(there.error());
  if (!graph.empty()) {
    if (const auto there = CheckFile(graph); !there) return tl::unexpected(there.error());
  }
  auto net = std::make_unique<Net>();
  const bool tensorflow = !graph.empty() || std::filesystem::path(model).extension() == ".pb";
  const auto read = CatchExceptions(model + ": cannot be read as a network", [&] {
    net->net =
        tensorflow ? cv::dnn::readNetFromTensorflow(model, graph) : cv::dnn::readNetFromONNX(model);
    net->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    cv::setNumThreads(threads > 0 ? threads : -1);
  });
  if (!read) return tl::unexpected(read.error());
  if (net->net.empty()) return Fail(model + ": cannot be read as a network: it has no layers");
  return Network(std::move(net));
}

Result<std::vector<Tensor>> Network::Run(const Tensor& input,
                                         const std::vector<std::string>& outputs) {
  if (const auto named = net_->CheckNames(outputs); !named) return tl::unexpected(named.error());
  std::vector<Tensor> tensors;
  const auto run = CatchExceptions("the network cannot be run", [&] {
    const cv::Mat blob(input.shape, CV_32F, const_cast<float*>(input.values.data()));
    net_->net.setInput(blob);
    std::vector<cv::String> names(outputs.begin(), outputs.end());
    if (names.empty()) names = net_->net.getUnconnectedOutLayersNames();
    std::vector<cv::Mat> mats;
    net_->net.forward(mats, names);
    for (const cv::Mat& mat : mats) {
      CV_CheckTypeEQ(mat.type(), CV_32F, "outputs are single floats");
      tensors.push_back(FromMat(mat));
    }
  });
  if (!run) return tl::unexpected(run.error());
  return tensors;
}

}  // namespace vismap
