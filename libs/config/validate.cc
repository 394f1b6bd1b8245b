#include <algorithm>
#include <cmath>
#include <set>

#include "base/option_check.h"
#include "config/config.h"

namespace vismap {
namespace {

constexpr double kDay = 86400;  // [s]

std::vector<std::string> Problems(const VoxelGridOptions& grid) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, grid.voxel_size_m, 0.001, 1);
  VISMAP_CHECK_RANGE(check, grid.truncation_voxels, 3, 32);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const MeshingOptions& meshing) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, meshing.min_weight, 0, 1e6);
  VISMAP_CHECK_RANGE(check, meshing.min_observations, 0, 255);
  VISMAP_CHECK_RANGE(check, meshing.jump_fraction, 0, 10);
  VISMAP_CHECK_AT_LEAST(check, meshing.min_component_triangles, 0);
  VISMAP_CHECK_RANGE(check, meshing.island_max_share, 0, 1);
  VISMAP_CHECK_RANGE(check, meshing.island_max_area_m2, 0, 1e6);
  VISMAP_CHECK_RANGE(check, meshing.contact_voxels, 0, 10);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const StructureOptions& structure) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, structure.structure_flatness_m, 0, 1);
  VISMAP_CHECK_RANGE(check, structure.structure_share, 0, 1);
  VISMAP_CHECK_RANGE(check, structure.structure_area_m2, 0, 1e6);
  VISMAP_CHECK_RANGE(check, structure.table_share, 0, 1);
  VISMAP_CHECK_RANGE(check, structure.table_area_m2, 0, 1e6);
  check.Unless(structure.table_low_m > 0 && structure.table_high_m >= structure.table_low_m &&
                   structure.ceiling_low_m > structure.table_high_m,
               "table_low_m, table_high_m, ceiling_low_m: 0 < table_low_m <= table_high_m < "
               "ceiling_low_m does not hold");
  VISMAP_CHECK_RANGE(check, structure.max_tilt_deg, 0, 45);
  VISMAP_CHECK_RANGE(check, structure.flush_roughness, 0, 100);
  VISMAP_CHECK_RANGE(check, structure.flush_gap_m, 0, 1e6);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const ObjectOptions& objects) {
  OptionCheck check;
  VISMAP_CHECK_AT_LEAST(check, objects.min_instance_points, 0);
  VISMAP_CHECK_AT_LEAST(check, objects.min_discovered_points, 0);
  VISMAP_CHECK_AT_LEAST(check, objects.min_discovered_frames, 0);
  VISMAP_CHECK_RANGE(check, objects.min_discovered_area_m2, 0, 1e6);
  VISMAP_CHECK_RANGE(check, objects.min_discovered_fill, 0, 1);
  VISMAP_CHECK_RANGE(check, objects.removed_max_rest, 0, 10);
  VISMAP_CHECK_AT_LEAST(check, objects.removed_max_count, 0);
  VISMAP_CHECK_AT_LEAST(check, objects.removed_max_age_s, 0);
  VISMAP_CHECK_RANGE(check, objects.box_outliers, 0, 0.49);
  VISMAP_CHECK_RANGE(check, objects.part_gap_m, 0, 100);
  VISMAP_CHECK_RANGE(check, objects.min_part_share, 0, 1);
  VISMAP_CHECK_RANGE(check, objects.min_part_contact, 0, 1);
  VISMAP_CHECK_RANGE(check, objects.max_whole_size_m, 0, 100);
  VISMAP_CHECK_RANGE(check, objects.max_whole_leak, 0, 1);
  check.Add("", Problems(objects.structure));
  return std::move(check).problems();
}

std::vector<std::string> Problems(const OccupancyOptions& options, const VoxelGridOptions& grid) {
  OptionCheck check;
  check.Unless(
      options.occupied_max_voxels >= 0 && options.occupied_max_voxels <= grid.truncation_voxels,
      "occupied_max_voxels must be in [0, grid.truncation_voxels]");
  check.Unless(options.free_min_voxels >= options.occupied_max_voxels &&
                   options.free_min_voxels <= grid.truncation_voxels,
               "free_min_voxels must be in [occupied_max_voxels, grid.truncation_voxels]");
  VISMAP_CHECK_RANGE(check, options.min_observations, 1, 255);
  VISMAP_CHECK_RANGE(check, options.thin_hits, 0, 12);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const GroundGridOptions& ground, const VoxelGridOptions& grid) {
  OptionCheck check;
  check.Add("", Validate(ground));
  const auto resolved = ChooseOctreeGrid(grid.voxel_size_m, ground.resolution_m);
  if (!resolved) check.Unless(false, "resolution_m: " + resolved.error().message);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const OctreeOptions& octree, const VoxelGridOptions& grid) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, octree.free_fraction, 0.01, 1);
  VISMAP_CHECK_RANGE(check, octree.shell_m, 0, 100);
  const auto resolved = ChooseOctreeGrid(grid.voxel_size_m, octree.resolution_m);
  if (!resolved) check.Unless(false, "resolution_m: " + resolved.error().message);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const DepthSegmenterOptions& segmenter) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, segmenter.detection_timeout_s, 0.01, 3600);
  VISMAP_CHECK_RANGE(check, segmenter.max_waiting_frames, 1, 10000);
  VISMAP_CHECK_RANGE(check, segmenter.queue_mb, 1, 65536);
  VISMAP_CHECK_RANGE(check, segmenter.max_wait_s, 1, kDay);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const MapServerOptions& server) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, server.save_period_s, 0, kDay);
  VISMAP_CHECK_RANGE(check, server.map_folder_mb, 1, 1048576);
  VISMAP_CHECK_RANGE(check, server.mesh_period_s, 0, kDay);
  VISMAP_CHECK_RANGE(check, server.objects_period_s, 0, kDay);
  VISMAP_CHECK_RANGE(check, server.queue_mb, 1, 65536);
  VISMAP_CHECK_RANGE(check, server.max_wait_s, 1, kDay);
  VISMAP_CHECK_RANGE(check, server.frame_journal_mb, 0, 16777216);
  VISMAP_CHECK_RANGE(check, server.checkpoint_frames, 1, 1000000);
  VISMAP_CHECK_RANGE(check, server.checkpoint_mb, 1, 1048576);
  check.Unless(
      server.frame_journal_mb == 0 || !server.frame_journal.empty() || !server.save_on_exit.empty(),
      "frame_journal_mb needs map_server.frame_journal or map_server.save_on_exit to say "
      "where");
  check.Unless(
      !server.accept_corrections || server.frame_journal_mb > 0,
      "accept_corrections needs map_server.frame_journal_mb, since a corrected map is made "
      "of the frames in it");
  check.Unless(!server.recover || !server.save_on_exit.empty(),
               "recover needs map_server.save_on_exit to say from where");
  check.Unless(server.save_period_s == 0 || !server.save_on_exit.empty(),
               "save_period_s needs map_server.save_on_exit to say where");
  return std::move(check).problems();
}

std::vector<std::string> Problems(const OctomapExporterOptions& exporter,
                                  const VoxelGridOptions& grid, const OctreeOptions& octree) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, exporter.period_s, 0, kDay);
  VISMAP_CHECK_RANGE(check, exporter.max_map_mb, 1, 1048576);
  VISMAP_CHECK_RANGE(check, exporter.repeat_mb_s, 0, 1000);
  VISMAP_CHECK_RANGE(check, exporter.grid_period_s, 0, kDay);
  const auto fine = ChooseOctreeGrid(grid.voxel_size_m, octree.resolution_m);
  constexpr double kMostLeaves = 28, kMostDistanceLeaves = 89, kMostBodyLeaves = 100;
  if (fine) {
    VISMAP_CHECK_RANGE(check, exporter.robot_radius_m, 0, kMostLeaves * fine->resolution);
    VISMAP_CHECK_RANGE(check, exporter.distance_limit_m, 0, kMostDistanceLeaves * fine->resolution);
    VISMAP_CHECK_RANGE(check, exporter.clear_start_m, 0, kMostBodyLeaves * fine->resolution);
  }
  const auto coarse = ChooseOctreeGrid(grid.voxel_size_m, exporter.coarse_resolution_m);
  if (!coarse) check.Unless(false, "coarse_resolution_m: " + coarse.error().message);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const ViewerOptions& viewer) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, viewer.max_clients, 1, 1000);
  VISMAP_CHECK_RANGE(check, viewer.budget_mb_s, 0.01, 10000);
  VISMAP_CHECK_RANGE(check, viewer.max_picture_hz, 0.1, 60);
  VISMAP_CHECK_RANGE(check, viewer.max_map_mb, 1, 1048576);
  VISMAP_CHECK_RANGE(check, viewer.evidence_mb, 0, 1048576);
  VISMAP_CHECK_RANGE(check, viewer.evidence_hz, 0.01, 60);
  VISMAP_CHECK_RANGE(check, viewer.log_mb, 16, 1048576);
  check.Unless(viewer.hosts.size() <= 64, "hosts must be at most 64");
  return std::move(check).problems();
}

std::vector<std::string> Problems(const SensorReplayOptions& replay) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, replay.speed, 0, 1000);
  VISMAP_CHECK_RANGE(check, replay.window_frames, 1, 1000);
  VISMAP_CHECK_RANGE(check, replay.resend_s, 0.01, 3600);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const DetectorOptions& detector) {
  OptionCheck check;
  VISMAP_CHECK_AT_LEAST(check, detector.camera_id, -1);
  VISMAP_CHECK_RANGE(check, detector.dnn.input_size_px, 0, 4096);
  VISMAP_CHECK_RANGE(check, detector.dnn.min_score, 0, 1);
  VISMAP_CHECK_RANGE(check, detector.dnn.nms_iou, 0, 1);
  VISMAP_CHECK_RANGE(check, detector.dnn.mask_threshold, 0, 1);
  VISMAP_CHECK_RANGE(check, detector.dnn.max_detections, 1, 1000);
  VISMAP_CHECK_RANGE(check, detector.dnn.threads, 0, 1024);
  return std::move(check).problems();
}

std::vector<std::string> Problems(const HubOptions& hub) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, hub.queue_mb, 1, 65536);
  VISMAP_CHECK_AT_LEAST(check, hub.socket_buffer_bytes, 0);
  VISMAP_CHECK_RANGE(check, hub.max_clients, 1, 10000);
  VISMAP_CHECK_RANGE(check, hub.patience_s, 0.1, 60);
  VISMAP_CHECK_RANGE(check, hub.greeting_s, 0.1, 60);
  VISMAP_CHECK_RANGE(check, hub.max_wait_s, 0.1, 60);
  VISMAP_CHECK_RANGE(check, hub.max_hold_s, 0, 86400);
  VISMAP_CHECK_RANGE(check, hub.rejoin_s, 0, 60);
  VISMAP_CHECK_RANGE(check, hub.total_mb, 1, 1048576);
  return std::move(check).problems();
}

bool IsChannelName(const std::string& name) {
  constexpr const char* kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-/.#";
  return !name.empty() && name.size() <= 63 &&
         name.find_first_not_of(kAllowed) == std::string::npos;
}

std::vector<std::string> Problems(const BridgeOptions& bridge) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, bridge.queue_mb, 1, 65536);
  const auto check_channels = [&](const char* key, const std::vector<std::string>& channels) {
    check.Unless(channels.size() <= 64, std::string(key) + " must have at most 64 channels");
    for (const std::string& channel : channels) {
      check.Unless(IsChannelName(channel),
                   std::string(key) + ": '" + channel +
                       "' is not the name of a channel (letters, digits, _ - / . and #)");
    }
  };
  check_channels("send", bridge.send);
  check_channels("receive", bridge.receive);
  return std::move(check).problems();
}

bool IsNoneValue(double value) { return value >= 0 && value <= 1e6; }

std::vector<std::string> Problems(const AdapterCameraOptions& camera) {
  OptionCheck check;
  VISMAP_CHECK_AT_LEAST(check, camera.camera_id, 0);
  VISMAP_CHECK_RANGE(check, camera.depth_unit_m, 1e-6, 1);
  VISMAP_CHECK_RANGE(check, camera.pair_within_ms, 0, 1000);
  VISMAP_CHECK_RANGE(check, camera.wait_ms, 0, 60000);
  VISMAP_CHECK_RANGE(check, camera.max_gap_ms, 1, 10000);
  VISMAP_CHECK_RANGE(check, camera.intrinsics_wait_ms, 0, 60000);
  VISMAP_CHECK_RANGE(check, camera.queue_mb, 1, 65536);
  check.Unless(camera.intrinsics.empty() || camera.intrinsics.size() == 4,
               "intrinsics must be the four numbers fx, fy, cx, cy");
  check.Unless(camera.distortion.empty() || !camera.intrinsics.empty(),
               "distortion needs adapter.intrinsics");
  check.Unless(camera.mounts.size() <= 64, "mounts must be at most 64");
  check.Unless(camera.pose_channels.size() <= 64, "pose_channels must be at most 64");
  check.Unless(camera.none_values.size() <= 64 &&
                   std::all_of(camera.none_values.begin(), camera.none_values.end(), IsNoneValue),
               "none_values must be at most 64 numbers in [0, 1000000]");
  return std::move(check).problems();
}

std::vector<std::string> Problems(const AdapterOptions& adapter) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, adapter.publish_period_s, 0.01, kDay);
  VISMAP_CHECK_RANGE(check, adapter.cloud_spacing_m, 0.001, 10);
  VISMAP_CHECK_RANGE(check, adapter.costmap_resolution_m, 0.001, 10);
  VISMAP_CHECK_RANGE(check, adapter.costmap_unknown, -1, 100);
  check.Unless(adapter.costmap_min_z_m < adapter.costmap_max_z_m,
               "costmap_min_z_m must be below costmap_max_z_m");
  if (adapter.camera.empty())
    check.Add("", Problems(static_cast<const AdapterCameraOptions&>(adapter)));
  check.Unless(adapter.camera.size() <= 64, "camera must be given at most 64 times");
  std::set<int> ids;
  for (const AdapterCameraOptions& camera : adapter.camera) {
    const std::string name = "camera " + std::to_string(camera.camera_id);
    check.Add(name + ": ", Problems(camera));
    check.Unless(ids.insert(camera.camera_id).second,
                 name + " is there twice; every camera needs a camera_id of its own");
  }
  return std::move(check).problems();
}

}  // namespace

std::vector<std::string> Validate(const VismapConfig& config) {
  OptionCheck check;
  check.Add("grid.", Problems(config.grid));
  check.Add("", Validate(static_cast<const SegmentationStageOptions&>(config)));
  check.Add("association.", Validate(config.association));
  check.Add("integration.", Validate(config.integration));
  check.Unless(config.association.min_range_m == config.integration.min_range_m &&
                   config.association.max_range_m == config.integration.max_range_m,
               "association and integration must have one range");
  check.Add("meshing.", Problems(config.meshing));
  check.Add("objects.", Problems(config.objects));
  check.Unless(!config.up_W || std::abs(config.up_W->norm() - 1) < 1e-3,
               "objects.up_W must have unit length");
  check.Add("free_space.", Problems(config.free_space, config.grid));
  check.Add("octree.", Problems(config.octree, config.grid));
  check.Add("ground_grid.", Problems(config.ground_grid, config.grid));
  check.Add("depth_segmenter.", Problems(config.depth_segmenter));
  check.Add("map_server.", Problems(config.map_server));
  check.Add("octomap_exporter.", Problems(config.octomap_exporter, config.grid, config.octree));
  check.Add("viewer.", Problems(config.viewer));
  check.Add("sensor_replay.", Problems(config.sensor_replay));
  check.Add("detector.", Problems(config.detector));
  check.Add("hub.", Problems(config.hub));
  check.Add("bridge.", Problems(config.bridge));
  check.Add("adapter.", Problems(config.adapter));
  return std::move(check).problems();
}

}  // namespace vismap
