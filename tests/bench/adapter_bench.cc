// What vismap-adapter costs: DimOS's colour and depth images at a rate through a hub, to
// RGBD_FRAME. Starts its own hub and adapter. Prints how many frames came out, the CPU time of the
// adapter per frame, and the time from the last message that a frame needs (the pose after it) to
// the arrival of RGBD_FRAME, by way of the hub twice. With --surface-blocks the adapter also
// publishes a large surface that changes every second.

#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>
#include <vismap/rgbd_frame_t.hpp>

#include "runtime/clock.h"
#include "runtime/command_line.h"
#include "runtime/transport.h"
#include "support/foreign_builder.h"
#include "wire/channels.h"
#include "wire/mesh_update.h"

extern char** environ;

namespace vismap {
namespace {

using namespace foreign_test;  // NOLINT

struct BenchArguments {
  int width = 848, height = 480, port = 7790;
  double rate = 30, seconds = 20;
  int surface_blocks = 0;
};

/// A started program, which is stopped with this object.
class Program {
 public:
  Program(const std::string& name, std::vector<std::string> words) {
    const auto self = std::filesystem::read_symlink("/proc/self/exe");
    std::filesystem::path build = self.parent_path();
    while (!std::filesystem::exists(build / "bin" / name) && build.has_relative_path())
      build = build.parent_path();
    words.insert(words.begin(), (build / "bin" / name).string());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawn(&pid_, words[0].c_str(), nullptr, nullptr, arguments.data(), environ) != 0)
      pid_ = -1;
  }
  ~Program() {
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// User and system time [s].
  double CpuSeconds() const {
    std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
    std::string text;
    std::getline(file, text);
    std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 2)));
    std::string skipped;
    for (int i = 0; i < 11; ++i) fields >> skipped;
    double user = 0, system = 0;
    fields >> user >> system;
    return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  }

 private:
  pid_t pid_ = -1;
};

Bytes BenchImage(const BenchArguments& arguments, int64_t utime, const std::string& encoding,
                 int pixel_bytes) {
  foreign::sensor_msgs::Image image{};
  image.header = RosHeader(utime, "optical");
  image.width = arguments.width;
  image.height = arguments.height;
  image.encoding = encoding;
  image.step = arguments.width * pixel_bytes;
  image.data.resize(static_cast<size_t>(image.step) * static_cast<size_t>(image.height));
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<uint8_t>(i * i >> 7);
  image.data_length = static_cast<int32_t>(image.data.size());
  return Pack(image);
}

Bytes BenchInfo(const BenchArguments& arguments, int64_t utime) {
  foreign::sensor_msgs::CameraInfo info{};
  info.header = RosHeader(utime, "optical");
  info.width = arguments.width;
  info.height = arguments.height;
  info.K[0] = info.K[4] = 0.75 * arguments.width;
  info.K[2] = 0.5 * arguments.width;
  info.K[5] = 0.5 * arguments.height;
  return Pack(info);
}

/// A surface of flat blocks; `full`, or only the first block again.
Bytes BenchSurface(int blocks, int64_t revision, bool full) {
  constexpr int kSide = 8;  // vertices along a block
  MeshUpdate update;
  update.map_id = "bench";
  update.full = full;
  update.base_revision = full ? -1 : revision - 1;
  update.block_size = 0.4;
  update.mesh.revision = revision;
  for (int i = 0; i < (full ? blocks : 1); ++i) {
    BlockMesh block{{i / 200, i % 200, 0}, {}};
    for (int k = 0; k < kSide * kSide; ++k) {
      MeshVertex vertex;
      vertex.position_W = {
          0.4F * static_cast<float>(i / 200) + 0.05F * static_cast<float>(k / kSide),
          0.4F * static_cast<float>(i % 200) + 0.05F * static_cast<float>(k % kSide),
          0.001F * static_cast<float>(revision % 100)};
      vertex.normal_W = Eigen::Vector3f::UnitZ();
      block.mesh.vertices.push_back(vertex);
      const auto at = static_cast<uint32_t>(k);
      if (k >= kSide && k % kSide > 0) block.mesh.triangles.push_back({at, at - 1, at - kSide});
    }
    update.mesh.blocks.push_back(std::move(block));
  }
  mesh_delta_t message = Encode(update);
  message.source = "bench";
  message.seq = revision;
  return Pack(message);
}

Result<std::unique_ptr<Transport>> Connect(int port) {
  const double end = MonotonicSeconds() + 10;
  while (true) {
    auto transport = OpenTcpqTransport({"127.0.0.1", static_cast<uint16_t>(port)}, nullptr);
    if (transport || MonotonicSeconds() > end) return transport;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

double Quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<size_t>(part * static_cast<double>(values.size())))];
}

/// The frames on their way, by utime, and how long they took.
struct Latencies {
  std::map<int64_t, double> sent;  // MonotonicSeconds
  std::vector<double> ms;

  void Receive(Transport* transport, double until) {
    while (true) {
      transport->Receive([this](const std::string&, std::span<const uint8_t> data) {
        rgbd_frame_t frame{};
        const double now = MonotonicSeconds();
        if (frame.decode(data.data(), 0, static_cast<int>(data.size())) < 0) return;
        if (const auto found = sent.find(frame.utime); found != sent.end())
          ms.push_back((now - found->second) * 1e3);
      });
      const double left = until - MonotonicSeconds();
      if (left <= 0) return;
      pollfd waiting{transport->fd(), POLLIN, 0};
      if (!transport->pending()) poll(&waiting, 1, std::max(1, static_cast<int>(left * 1e3)));
    }
  }
};

int Measure(const BenchArguments& arguments) {
  const std::string url = "tcpq://127.0.0.1:" + std::to_string(arguments.port);
  const Program hub("vismap-hub", {"--listen", "127.0.0.1:" + std::to_string(arguments.port)});
  const auto robot = Connect(arguments.port), listener = Connect(arguments.port);
  if (!robot || !listener) {
    std::fprintf(stderr, "adapter_bench: no hub at %s\n", url.c_str());
    return 1;
  }
  (*listener)->Subscribe(kRgbdFrameChannel.name);
  std::vector<std::string> options = {"--preset", "dimos", "--lcm-url", url};
  if (arguments.surface_blocks > 0) {
    options.insert(options.end(), {"--global-map", "/map#sensor_msgs.PointCloud2"});
  }
  const Program adapter("vismap-adapter", options);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  if (arguments.surface_blocks > 0) {
    (*robot)->Publish(kMeshDeltaChannel.name, BenchSurface(arguments.surface_blocks, 0, true));
    std::this_thread::sleep_for(std::chrono::seconds(2));
  }

  const auto frames = static_cast<int>(arguments.rate * arguments.seconds);
  const int64_t start_utime = WallUtime();
  const double start = MonotonicSeconds(), cpu = adapter.CpuSeconds();
  Latencies latencies;
  (*robot)->Publish(kInfoChannel, BenchInfo(arguments, start_utime));
  for (int i = 0; i < frames; ++i) {
    const double due = start + i / arguments.rate;
    latencies.Receive(listener->get(), due);
    const int64_t utime = start_utime + static_cast<int64_t>(i / arguments.rate * 1e6);
    if (arguments.surface_blocks > 0 && i % static_cast<int>(arguments.rate) == 0) {
      (*robot)->Publish(
          kMeshDeltaChannel.name,
          BenchSurface(arguments.surface_blocks, 1 + i / static_cast<int>(arguments.rate), false));
    }
    const auto pose = [&](int64_t at) {
      return Tf({Transform(at, "world", "optical", BodyAt(at - start_utime))});
    };
    const Bytes color = BenchImage(arguments, utime, "rgb8", 3);
    const Bytes depth = BenchImage(arguments, utime, "16UC1", 2);
    (*robot)->Publish(kTfChannel, pose(utime - 5000));
    (*robot)->Publish(kColorChannel, color);
    (*robot)->Publish(kDepthChannel, depth);
    latencies.sent[utime] = MonotonicSeconds();
    (*robot)->Publish(kTfChannel, pose(utime + 5000));
  }
  latencies.Receive(listener->get(), MonotonicSeconds() + 1);
  const double used = adapter.CpuSeconds() - cpu;
  std::printf(
      "%d frames of %dx%d at %.0f Hz: %zu came out, %.2f ms CPU per frame, "
      "latency median %.2f ms, 95 %% %.2f ms, max %.2f ms\n",
      frames, arguments.width, arguments.height, arguments.rate, latencies.ms.size(),
      used / frames * 1e3, Quantile(latencies.ms, 0.5), Quantile(latencies.ms, 0.95),
      Quantile(latencies.ms, 1));
  return latencies.ms.size() + 1 >= static_cast<size_t>(frames) ? 0 : 1;
}

}  // namespace
}  // namespace vismap

int main(int argc, char** argv) {
  vismap::BenchArguments arguments;
  vismap::CommandLine line("adapter_bench", "Measures vismap-adapter with images of DimOS.");
  line.Option("--width", &arguments.width, "Width of the images").Positive();
  line.Option("--height", &arguments.height, "Height of the images").Positive();
  line.Option("--rate", &arguments.rate, "Frames per second").Positive();
  line.Option("--seconds", &arguments.seconds, "Duration").Positive();
  line.Option("--surface-blocks", &arguments.surface_blocks,
              "Also publish a surface of so many blocks of 64 vertices")
      .AtLeast(0);
  line.Option("--port", &arguments.port, "Port of the hub").Positive();
  if (const auto end = line.Parse(argc, argv)) return static_cast<int>(*end);
  line.Apply();
  return vismap::Measure(arguments);
}
