#include "adapter/fitted_outputs.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "base/class_names.h"
#include "base/format.h"
#include "foreign/map_messages.h"
#include "foreign/presets.h"
#include "objects/object_mesh.h"
#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

constexpr double kCoarser = 1.25;       // from one spacing to the next
constexpr double kCoarsest = 100;       // [m]
constexpr size_t kPointBytes = 16;      // of a point in a cloud
constexpr size_t kTextPointBytes = 64;  // at least, of a point in JSON
constexpr size_t kObjectBytes = 2048;   // at most, of an object in any message

/// A surface, and its points at the spacings that were asked for.
class ThinnedSurface {
 public:
  explicit ThinnedSurface(const Mesh& mesh) : mesh_(mesh) {}
  const std::vector<SurfacePoint>& At(double spacing) {
    const auto [at, is_new] = points_.try_emplace(spacing);
    if (is_new) at->second = ThinOut(mesh_, spacing);
    return at->second;
  }

 private:
  const Mesh& mesh_;
  std::map<double, std::vector<SurfacePoint>> points_;
};

size_t FloatBytes(const std::vector<Mesh>& meshes) {
  size_t floats = 0;
  for (const Mesh& mesh : meshes) floats += 3 * (mesh.vertices.size() + mesh.triangles.size());
  return floats * sizeof(float);
}

double FinerThan(double spacing, double wanted) {
  constexpr double kFinest = 0.001;  // [m]
  const double finer = spacing / kCoarser;
  return finer < std::max(kFinest, wanted) ? wanted : finer;
}

std::string SpacingText(double spacing) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f cm", 100 * spacing);
  return spacing == 0 ? "that of the map" : text;
}

}  // namespace

size_t LargestOutput(const LcmUrl& url) {
  constexpr size_t kMost = 8 * kMegabyte, kUnknownBuffer = 4 * kMegabyte;
  if (!url.provider.ends_with("udpm")) return kMaxMessageBytes;
  const auto buffer = static_cast<size_t>(std::max(0, url.receive_buffer));
  return std::min(kMost, (buffer == 0 ? kUnknownBuffer : buffer) / 2);
}

FittedOutputs::FittedOutputs(const AdapterOptions& options, size_t most_bytes, OutputReport* report,
                             Send send, std::function<bool()> stopped)
    : options_(options),
      root_(CamerasOf(options).front().root),
      most_bytes_(most_bytes),
      report_(report),
      send_(std::move(send)),
      stopped_(std::move(stopped)) {}

template <typename Message>
void FittedOutputs::SendNow(const std::string& channel, Message message) {
  const RawBytes bytes = PackRaw(message);
  const bool sent = send_(channel, bytes);
  report_->Count(sent ? "map_messages_published" : "map_messages_unsent");
  report_->SetFinding("sending on " + channel,
                      sent ? ""
                           : "the last message for " + channel +
                                 " was not sent, since there is no connection to the robot's bus");
}

// Sends what `make` returns for the wanted spacing, or for the next coarser one that fits. `make`
// returns nullopt when the message would surely be too large.
template <typename Make>
void FittedOutputs::Publish(const std::string& channel, double wanted, const char* key,
                            const Make& make) {
  if (channel.empty()) return;
  double& spacing = spacings_.try_emplace(channel, wanted).first->second;
  while (spacing <= std::max(kCoarsest, wanted)) {
    if (stopped_()) return;
    auto message = make(spacing);
    const size_t size = message ? static_cast<size_t>(message->getEncodedSize()) : most_bytes_ + 1;
    if (size <= most_bytes_) {
      TellSpacing(channel, wanted, spacing, key);
      SendNow(channel, std::move(*message));
      // A map that has shrunk gets its spacing back.
      if (size < most_bytes_ / 4) spacing = FinerThan(spacing, wanted);
      return;
    }
    spacing = spacing == 0 ? options_.cloud_spacing_m : spacing * kCoarser;
  }
  spacing = wanted;
  report_->Count("map_messages_unsent");
  report_->SetFinding("size on " + channel, "no message for " + channel + " fits into " +
                                                FormatBytes(most_bytes_) + ", so none is sent");
}

void FittedOutputs::TellSpacing(const std::string& channel, double wanted, double spacing,
                                const char* key) {
  report_->SetFinding("size on " + channel, spacing == wanted
                                                ? ""
                                                : "the spacing on " + channel + " is " +
                                                      SpacingText(spacing) + " instead of " +
                                                      SpacingText(wanted) + " (" + key +
                                                      "), since a message on this bus may have " +
                                                      FormatBytes(most_bytes_));
}

// As many objects as every message takes.
std::span<const ObjectSummary> FittedOutputs::Bounded(std::span<const ObjectSummary> objects) {
  const size_t most = most_bytes_ / kObjectBytes;
  const size_t left_out = objects.size() - std::min(most, objects.size());
  report_->SetFinding("number of objects",
                      left_out == 0 ? ""
                                    : FormatCount(left_out, "object is", "objects are") +
                                          " left out for other programs, since a message on this "
                                          "bus may have " +
                                          FormatBytes(most_bytes_));
  return objects.first(objects.size() - left_out);
}

void FittedOutputs::PublishSurface(const Mesh& mesh, int64_t utime,
                                   std::span<const ObjectSummary> objects, int64_t objects_utime) {
  using foreign::drake::lcmt_point_cloud, foreign::drake::lcmt_viewer_link_data;
  using foreign::robotlocomotion::viewer2_comms_t, foreign::sensor_msgs::PointCloud2;
  ThinnedSurface surface(mesh);
  const std::span<const ObjectSummary> shown = Bounded(objects);
  const double wanted = options_.cloud_spacing_m;
  constexpr const char* kKey = "adapter.cloud_spacing_m";
  const auto fits = [&](size_t count, size_t bytes) { return count <= most_bytes_ / bytes; };
  Publish(options_.cloud_channel, wanted, kKey, [&](double spacing) -> std::optional<PointCloud2> {
    if (!fits(surface.At(spacing).size(), kPointBytes)) return std::nullopt;
    return ToPointCloud2(surface.At(spacing), root_, utime);
  });
  Publish(options_.drake_cloud_channel, wanted, kKey,
          [&](double spacing) -> std::optional<lcmt_point_cloud> {
            if (!fits(surface.At(spacing).size(), kPointBytes)) return std::nullopt;
            return ToDrakeCloud(surface.At(spacing), root_, utime);
          });
  Publish(options_.drake_objects_channel, 0, "the surface of objects",
          [&](double spacing) -> std::optional<lcmt_viewer_link_data> {
            const std::vector<Mesh> meshes =
                CutObjects(spacing == 0 ? mesh : Coarsened(mesh, spacing), shown);
            if (!fits(FloatBytes(meshes), 1)) return std::nullopt;
            return ToDeformable(shown, meshes, ClassName);
          });
  std::set<std::string> boxes;
  Publish(options_.director_channel, wanted, kKey,
          [&](double spacing) -> std::optional<viewer2_comms_t> {
            if (!fits(surface.At(spacing).size(), kTextPointBytes)) return std::nullopt;
            boxes = boxes_in_director_;
            return ToTreeviewer(surface.At(spacing), shown, ClassName, utime, &boxes);
          });
  boxes_in_director_ = boxes;
  if (!options_.detections_channel.empty())
    SendNow(options_.detections_channel, ToDetections(shown, ClassName, root_, objects_utime));
}

void FittedOutputs::PublishSpace(const OccupancyMap& space, int64_t utime) {
  using foreign::nav_msgs::OccupancyGrid;
  Publish(options_.costmap_channel, options_.costmap_resolution_m, "adapter.costmap_resolution_m",
          [&](double resolution) -> std::optional<OccupancyGrid> {
            Result<OccupancyGrid> costmap =
                ToCostmap(space,
                          {resolution, options_.costmap_min_z_m, options_.costmap_max_z_m,
                           options_.costmap_unknown},
                          root_, utime);
            if (!costmap) return std::nullopt;
            return std::move(*costmap);
          });
}

}  // namespace vismap
