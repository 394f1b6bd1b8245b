#include <cmath>

#include "config/config.h"

namespace vismap {
namespace {

/// Collects a sentence for every condition that does not hold.
class Problems {
 public:
  void Unless(bool ok, const std::string& sentence) {
    if (!ok) list_.push_back(sentence);
  }
  void Add(const std::string& prefix, const std::vector<std::string>& list) {
    for (const std::string& problem : list) list_.push_back(prefix + problem);
  }
  std::vector<std::string> list() && { return std::move(list_); }

 private:
  std::vector<std::string> list_;
};

bool InRange(double x, double low, double high) { return x >= low && x <= high; }  // false for NaN

void Check(const VoxelGridOptions& grid, Problems* problems) {
  problems->Unless(InRange(grid.voxel_size_m, 0.001, 1),
                   "grid.voxel_size_m must be in [0.001, 1] m");
  problems->Unless(InRange(grid.truncation_voxels, 3, 32),
                   "grid.truncation_voxels must be in [3, 32]");
}

void Check(const MeshingOptions& meshing, Problems* problems) {
  problems->Unless(InRange(meshing.min_weight, 0, 1e6), "meshing.min_weight must be in [0, 1e6]");
  problems->Unless(InRange(meshing.min_observations, 0, 255),
                   "meshing.min_observations must be in [0, 255]");
  problems->Unless(InRange(meshing.jump_fraction, 0, 10),
                   "meshing.jump_fraction must be in [0, 10]");
  problems->Unless(meshing.min_component_triangles >= 0,
                   "meshing.min_component_triangles must not be negative");
  problems->Unless(InRange(meshing.island_max_share, 0, 1),
                   "meshing.island_max_share must be in [0, 1]");
  problems->Unless(InRange(meshing.island_max_area_m2, 0, 1e6),
                   "meshing.island_max_area_m2 must be in [0, 1e6] m2");
  problems->Unless(InRange(meshing.contact_voxels, 0, 10),
                   "meshing.contact_voxels must be in [0, 10]");
}

void Check(const ObjectOptions& objects, Problems* problems) {
  problems->Unless(objects.min_instance_points >= 0,
                   "objects.min_instance_points must not be negative");
  problems->Unless(objects.min_discovered_points >= 0,
                   "objects.min_discovered_points must not be negative");
  problems->Unless(objects.min_discovered_frames >= 0,
                   "objects.min_discovered_frames must not be negative");
  problems->Unless(InRange(objects.min_discovered_area_m2, 0, 1e6),
                   "objects.min_discovered_area_m2 must be in [0, 1e6] m2");
  problems->Unless(InRange(objects.min_discovered_fill, 0, 1),
                   "objects.min_discovered_fill must be in [0, 1]");
  problems->Unless(InRange(objects.removed_max_rest, 0, 10),
                   "objects.removed_max_rest must be in [0, 10]");
  problems->Unless(objects.removed_max_count >= 0, "objects.removed_max_count must be 0 or more");
  problems->Unless(objects.removed_max_age_s >= 0, "objects.removed_max_age_s must be 0 or more");
  problems->Unless(InRange(objects.box_outliers, 0, 0.49),
                   "objects.box_outliers must be in [0, 0.49]");
  problems->Unless(InRange(objects.part_gap_m, 0, 100), "objects.part_gap_m must be in [0, 100] m");
  problems->Unless(InRange(objects.min_part_share, 0, 1),
                   "objects.min_part_share must be in [0, 1]");
  problems->Unless(InRange(objects.structure.structure_flatness_m, 0, 1),
                   "objects.structure_flatness_m must be in [0, 1] m");
  problems->Unless(InRange(objects.structure.structure_share, 0, 1),
                   "objects.structure_share must be in [0, 1]");
  problems->Unless(InRange(objects.structure.structure_area_m2, 0, 1e6),
                   "objects.structure_area_m2 must be in [0, 1e6] m2");
  problems->Unless(InRange(objects.structure.table_share, 0, 1),
                   "objects.table_share must be in [0, 1]");
  problems->Unless(InRange(objects.structure.table_area_m2, 0, 1e6),
                   "objects.table_area_m2 must be in [0, 1e6] m2");
  problems->Unless(objects.structure.table_low_m > 0 &&
                       objects.structure.table_high_m >= objects.structure.table_low_m &&
                       objects.structure.ceiling_low_m > objects.structure.table_high_m,
                   "objects: 0 < table_low_m <= table_high_m < ceiling_low_m does not hold");
  problems->Unless(InRange(objects.structure.max_tilt_deg, 0, 45),
                   "objects.max_tilt_deg must be in [0, 45]");
  problems->Unless(InRange(objects.structure.flush_roughness, 0, 100),
                   "objects.flush_roughness must be in [0, 100]");
  problems->Unless(InRange(objects.structure.flush_gap_m, 0, 1e6),
                   "objects.flush_gap_m must be in [0, 1e6] m");
}

void Check(const OccupancyOptions& options, const VoxelGridOptions& grid, Problems* problems) {
  problems->Unless(InRange(options.occupied_max_voxels, 0, grid.truncation_voxels),
                   "free_space.occupied_max_voxels must be in [0, grid.truncation_voxels]");
  problems->Unless(
      InRange(options.free_min_voxels, options.occupied_max_voxels, grid.truncation_voxels),
      "free_space.free_min_voxels must be in [occupied_max_voxels, grid.truncation_voxels]");
  problems->Unless(options.min_observations >= 1 && options.min_observations <= 255,
                   "free_space.min_observations must be in [1, 255]");
}

void Check(const OctreeOptions& octree, const VoxelGridOptions& grid, Problems* problems) {
  problems->Unless(InRange(octree.free_fraction, 0.01, 1),
                   "octree.free_fraction must be in [0.01, 1]");
  const Result<OctreeGrid> resolved = ChooseOctreeGrid(grid.voxel_size_m, octree.resolution_m);
  if (!resolved) problems->Unless(false, resolved.error().message);
}

void CheckPeriod(double period, const std::string& key, Problems* problems) {
  problems->Unless(InRange(period, 0, 86400), key + " must be in [0, 86400] s");
}

void Check(const BridgeOptions& bridge, Problems* problems) {
  problems->Unless(InRange(bridge.queue_mb, 1, 65536), "bridge.queue_mb must be in [1, 65536]");
  for (const auto* list : {&bridge.send, &bridge.receive}) {
    problems->Unless(list->size() <= 64, "bridge: at most 64 channels in each direction");
    for (const std::string& channel : *list) {
      const bool plain = channel.find_first_not_of(
                             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") ==
                         std::string::npos;
      problems->Unless(
          plain && !channel.empty() && channel.size() <= 63,
          "bridge: '" + channel + "' is not the name of a channel (letters, digits, _ and -)");
    }
  }
}

void Check(const DetectorOptions& detector, Problems* problems) {
  const DnnDetectorOptions& dnn = detector.dnn;
  problems->Unless(detector.camera_id >= -1, "detector.camera_id must be -1 or more");
  problems->Unless(InRange(dnn.input_size_px, 0, 4096),
                   "detector.input_size_px must be in [0, 4096]");
  problems->Unless(InRange(dnn.min_score, 0, 1), "detector.min_score must be in [0, 1]");
  problems->Unless(InRange(dnn.nms_iou, 0, 1), "detector.nms_iou must be in [0, 1]");
  problems->Unless(InRange(dnn.mask_threshold, 0, 1), "detector.mask_threshold must be in [0, 1]");
  problems->Unless(InRange(dnn.max_detections, 1, 1000),
                   "detector.max_detections must be in [1, 1000]");
  problems->Unless(InRange(dnn.threads, 0, 1024), "detector.threads must be in [0, 1024]");
}

void CheckProcesses(const VismapConfig& config, Problems* problems) {
  problems->Unless(InRange(config.depth_segmenter.detection_timeout_s, 0.01, 3600),
                   "depth_segmenter.detection_timeout_s must be in [0.01, 3600] s");
  problems->Unless(InRange(config.depth_segmenter.max_waiting_frames, 1, 10000),
                   "depth_segmenter.max_waiting_frames must be in [1, 10000]");
  const MapServerOptions& server = config.map_server;
  CheckPeriod(server.save_period_s, "map_server.save_period_s", problems);
  CheckPeriod(server.mesh_period_s, "map_server.mesh_period_s", problems);
  CheckPeriod(server.objects_period_s, "map_server.objects_period_s", problems);
  problems->Unless(!server.recover || !server.save_on_exit.empty(),
                   "map_server.recover needs map_server.save_on_exit to say from where");
  problems->Unless(server.save_period_s == 0 || !server.save_on_exit.empty(),
                   "map_server.save_period_s needs map_server.save_on_exit to say where");
  CheckPeriod(config.octomap_exporter.period_s, "octomap_exporter.period_s", problems);
  const SensorReplayOptions& replay = config.sensor_replay;
  problems->Unless(InRange(replay.speed, 0, 1000), "sensor_replay.speed must be in [0, 1000]");
  problems->Unless(InRange(replay.window_frames, 1, 1000),
                   "sensor_replay.window_frames must be in [1, 1000]");
  problems->Unless(InRange(replay.resend_s, 0.01, 3600),
                   "sensor_replay.resend_s must be in [0.01, 3600] s");
  Check(config.detector, problems);
  problems->Unless(InRange(config.hub.queue_mb, 1, 65536), "hub.queue_mb must be in [1, 65536]");
  problems->Unless(config.hub.socket_buffer_bytes >= 0,
                   "hub.socket_buffer_bytes must not be negative");
  problems->Unless(InRange(config.hub.max_clients, 1, 10000),
                   "hub.max_clients must be in [1, 10000]");
  problems->Unless(InRange(config.hub.patience_s, 0.1, 60),
                   "hub.patience_s must be in [0.1, 60] s");
  Check(config.bridge, problems);
}

}  // namespace

std::vector<std::string> Validate(const VismapConfig& config) {
  Problems problems;
  Check(config.grid, &problems);
  problems.Add("", Validate(static_cast<const SegmentationStageOptions&>(config)));
  problems.Add("association.", Validate(config.association));
  problems.Add("integration.", Validate(config.integration));
  problems.Unless(config.association.min_range_m == config.integration.min_range_m &&
                      config.association.max_range_m == config.integration.max_range_m,
                  "association and integration must have one range");
  Check(config.meshing, &problems);
  Check(config.objects, &problems);
  problems.Unless(!config.up_W || std::abs(config.up_W->norm() - 1) < 1e-3,
                  "objects.up_W must have unit length");
  Check(config.free_space, config.grid, &problems);
  Check(config.octree, config.grid, &problems);
  CheckProcesses(config, &problems);
  return std::move(problems).list();
}

}  // namespace vismap
