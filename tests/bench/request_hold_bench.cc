// How long a request to a map server holds the mapping: the longest time that the server's thread
// is busy at a stretch while the request is carried out. Also how long the answer takes.
//   request_hold_bench [SEQUENCE [FRAMES]]
//   wall   as it was, with other threads and programs on the same processors
//   held   without the time in which the thread could have gone on, but had no processor; what it
//          waits for files, locks or other threads counts. This is what has the goal.
//   cpu    processor time of the thread
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "base/parallel.h"
#include "codecs/frame_codec.h"
#include "map_server/map_server.h"
#include "runtime/clock.h"
#include "segmentation/segment_frame.h"
#include "simulation/sequence.h"
#include "support/recorded_map.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

constexpr double kGoal = 5;  // [ms]

struct Held {
  double wall = 0, held = 0, cpu = 0;  // at a stretch [ms]
  double answer = 0;                   // until the answer is there [ms]
  map_reply_t reply{};
};

// Processor time of this thread, which other programs do not disturb.
double ThreadSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// How long this thread has waited for a processor since its start.
double SecondsWithoutProcessor() {
  std::FILE* file = std::fopen("/proc/thread-self/schedstat", "r");
  if (file == nullptr) return 0;
  unsigned long long ran = 0, waited = 0;
  const bool read = std::fscanf(file, "%llu %llu", &ran, &waited) == 2;
  std::fclose(file);
  return read ? 1e-9 * static_cast<double>(waited) : 0;
}

class Bench {
 public:
  explicit Bench(const VismapConfig& config) : server_(config, bus_.get(), &status_) {
    bus_->SendByThread();  // as the map server does
    bus_->Subscribe<map_reply_t>(kMapReplyChannel, [this](const map_reply_t& reply) {
      reply_ = reply;
      answered_ = true;
    });
  }

  void Map(const std::string& sequence, int frames) {
    DatasetOptions selection;
    selection.max_frames = frames;
    const auto dataset = OpenSequence(sequence, "", selection);
    if (!dataset) throw std::runtime_error(dataset.error().message);
    for (size_t i = 0; i < (*dataset)->size(); ++i) {
      const auto frame = DecodeFrame(*(*dataset)->Read(i));
      server_.map().Integrate(SegmentFrame(*frame, nullptr, {}));
    }
    server_.map().PublishAll();
    Rest();
  }

  Held Ask(map_request_t request) {
    Rest();
    request.request_id = ++id_;
    request.map_id = server_.map().session().metadata().map_id;
    answered_ = false;
    bus_->Publish(kMapRequestChannel, request);
    Held held;
    const double start = MonotonicSeconds();
    while (!answered_ && MonotonicSeconds() < start + 60) {
      const double without = SecondsWithoutProcessor();
      const double begin = MonotonicSeconds(), cpu = ThreadSeconds();
      bus_->Spin(0);
      if (answered_) break;  // this was the time of the client, which unpacks the answer
      const double wall = MonotonicSeconds() - begin;
      held.cpu = std::max(held.cpu, 1e3 * (ThreadSeconds() - cpu));
      held.wall = std::max(held.wall, 1e3 * wall);
      held.held = std::max(held.held, 1e3 * (wall - (SecondsWithoutProcessor() - without)));
    }
    held.answer = 1e3 * (MonotonicSeconds() - start);
    held.reply = reply_;
    return held;
  }

  const SemanticMap& map() { return server_.map().session().map(); }
  /// The objects, largest first.
  std::vector<ObjectSummary> Objects() {
    auto objects = server_.map().publisher().objects().objects();
    std::sort(objects.begin(), objects.end(),
              [](const auto& a, const auto& b) { return a.points > b.points; });
    return objects;
  }

 private:
  // Until nothing waits, and the pause after the last request is over.
  void Rest() {
    const double end = MonotonicSeconds() + 0.6;
    while (bus_->Spin(0.01) || MonotonicSeconds() < end) {
    }
  }

  std::unique_ptr<Bus> bus_ = std::move(*Bus::Open({"memq://", "bench"}));
  Status status_{bus_.get(), "map-server"};
  MapServer server_;
  map_reply_t reply_{};
  bool answered_ = false;
  int64_t id_ = 0;
};

void Print(const char* name, Bench* bench, const map_request_t& request) {
  Held worst;
  for (int i = 0; i < 5; ++i) {
    const Held held = bench->Ask(request);
    worst.wall = std::max(worst.wall, held.wall);
    worst.held = std::max(worst.held, held.held);
    worst.cpu = std::max(worst.cpu, held.cpu);
    worst.answer = std::max(worst.answer, held.answer);
    worst.reply = held.reply;
  }
  std::printf("%-28s %8.2f %8.2f %8.2f %8.1f %8.1f  %10.0f  %s\n", name, worst.wall, worst.held,
              worst.cpu, kGoal, worst.answer,
              static_cast<double>(worst.reply.payload.size()) / 1000,
              worst.reply.ok ? "" : worst.reply.message.c_str());
  std::fflush(stdout);
}

map_request_t Verb(const std::string& verb, const std::string& argument = "") {
  map_request_t request{};
  request.verb = verb;
  request.argument = argument;
  return request;
}

int Main(int argc, char** argv) {
  const std::string sequence = argc > 1 ? argv[1] : "synthetic:room?frames=80";
  const TempFolder folder;
  VismapConfig config;
  config.map_server.map_folder = (folder / "maps").string();
  const ThreadLimit threads(2);
  Bench bench(config);
  bench.Map(sequence, argc > 2 ? std::atoi(argv[2]) : 1000);
  std::printf("%s: %zu blocks, %lld frames, %zu labels\n", sequence.c_str(),
              bench.map().voxels.size(), static_cast<long long>(bench.map().revision),
              bench.map().labels.records().size());
  const std::string largest =
      bench.Objects().empty()
          ? "class=couch"
          : "id=s" + std::to_string(Raw(bench.Objects().front().segments.front()));
  std::printf("%-28s %8s %8s %8s %8s %8s  %10s\n", "[ms]", "wall", "held", "cpu", "goal", "answer",
              "kB");
  Print("octree, whole map", &bench, Verb("octree"));
  map_request_t box = Verb("octree");
  box.has_bbx = true;
  const Eigen::Vector3d center = bench.map().last_camera_W;
  for (int axis = 0; axis < 3; ++axis) {
    box.bbx_min_W[axis] = center[axis] - 0.5;
    box.bbx_max_W[axis] = center[axis] + 0.5;
  }
  Print("octree, 1 m^3", &bench, box);
  map_request_t without = Verb("octree");
  without.without = largest;
  Print(("octree without " + largest).c_str(), &bench, without);
  without.verb = "occupancy";
  Print(("occupancy without " + largest).c_str(), &bench, without);
  Print("snapshot", &bench, Verb("snapshot"));
  Print("statistics", &bench, Verb("statistics"));
  Print("map", &bench, Verb("map"));
  Print("frames", &bench, Verb("frames", "positions=0"));
  Print("objects", &bench, Verb("objects"));
  Print("mesh (all for a follower)", &bench, Verb("mesh"));
  Print("mesh ply", &bench, Verb("mesh", "ply"));
  Print("mesh digest", &bench, Verb("mesh", "digest"));
  Print(("mesh " + largest).c_str(), &bench, Verb("mesh", largest));
  Print(("points " + largest).c_str(), &bench, Verb("points", largest));
  map_request_t save = Verb("save");
  save.path = "bench";
  Print("save", &bench, save);
  return 0;
}

}  // namespace
}  // namespace vismap

int main(int argc, char** argv) { return vismap::Main(argc, argv); }
