#include "map_tool/follow.h"

#include <unistd.h>

#include <cstdio>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/object_list_t.hpp>

#include "base/file.h"
#include "base/format.h"
#include "base/printable.h"
#include "exports/ply.h"
#include "runtime/catch_up.h"
#include "runtime/clock.h"
#include "wire/mesh_follower.h"

namespace vismap {
namespace {

class Viewer {
 public:
  explicit Viewer(Bus* bus) : catch_up_(bus, "mesh") {
    bus->Subscribe<mesh_delta_t>(
        kMeshDeltaChannel, [this](const mesh_delta_t& message) { return OnMeshDelta(message); });
    bus->Subscribe<object_list_t>(
        kObjectsChannel, [this](const object_list_t& message) { objects_ = message.n_objects; },
        Delivery::kLatest);
    bus->Every(0.25, [this] {
      mesh_.GiveUpStaleParts(MonotonicSeconds());
      if (!mesh_.in_sync()) catch_up_.Request(mesh_.position());
    });
    catch_up_.Request(mesh_.position());
  }

  const MeshFollower& mesh() const { return mesh_; }

 private:
  Result<void> OnMeshDelta(const mesh_delta_t& message) {
    switch (mesh_.Apply(message, MonotonicSeconds())) {
      case FollowOutcome::kApplied:
        Print();
        break;
      case FollowOutcome::kNeedsSnapshot:
        catch_up_.Request(mesh_.position());
        break;
      case FollowOutcome::kBroken:
        return Fail("the update to revision " + std::to_string(message.revision) +
                    " is inconsistent");
      case FollowOutcome::kTooLarge:
        return Fail("the surface needs more memory than a viewer takes, " +
                    FormatBytes(FollowLimits{}.max_bytes));
      case FollowOutcome::kWaiting:
      case FollowOutcome::kIgnored:
        break;
    }
    return {};
  }

  void Print() const {
    const auto count = [](size_t number, const char* what) {
      return FormatCount(static_cast<int64_t>(number), what);
    };
    std::printf("map %s: %s, %s in %s, %s, %s\n", PrintableText(mesh_.position().map_id).c_str(),
                FormatCount(mesh_.position().revision, "frame").c_str(),
                count(mesh_.triangle_count(), "triangle").c_str(),
                count(mesh_.block_count(), "block").c_str(),
                FormatCount(objects_, "object").c_str(),
                FormatCount(mesh_.gaps(), "lost update").c_str());
    std::fflush(stdout);
  }

  MeshFollower mesh_;
  CatchUp catch_up_;
  int objects_ = 0;
};

}  // namespace

Outcome RunFollow(const MapToolArguments& arguments, ProcessContext& context) {
  const auto bus = OpenBus(context.options, context.options.name + "-" + std::to_string(getpid()),
                           &context.stop);
  if (!bus) return ExitWith(ExitCode::kFailed, bus.error().message);
  const Viewer viewer(bus->get());
  (*bus)->Run([&] {
    return arguments.frames > 0 && viewer.mesh().in_sync() &&
           viewer.mesh().position().revision >= arguments.frames;
  });
  if (viewer.mesh().position().revision < 0)
    return ExitWith(ExitCode::kFailed,
                    "no MESH_DELTA was received; check that vismap-map-server is running");
  std::printf("mesh digest %s\n", viewer.mesh().Digest().c_str());
  if (arguments.out.empty()) return {};
  const Result<void> written = WriteFileAtomically(
      arguments.out, EncodePly(viewer.mesh().Joined(), {viewer.mesh().position().map_id, {}}));
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  return {};
}

}  // namespace vismap
