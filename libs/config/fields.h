#pragma once

#include <string>
#include <tuple>

#include "config/config.h"

namespace vismap::config {

// Which members of the option structs are keys of a config file. A key has the name of its member,
// and a section that of its struct in VismapConfig, so each name stands here once.

/// A member that is a key.
template <typename Options, typename Member>
struct Field {
  const char* key;
  Member Options::*member;
};

/// A member that is an option struct itself, whose members are keys of the same section. Their keys
/// begin with `prefix`.
template <typename Options, typename Member>
struct Nested {
  const char* prefix;
  Member Options::*member;
};

/// A key that sets all members of a noise model to those of a known sensor.
template <typename Options>
struct Preset {
  const char* key;
  DepthNoiseModel Options::*member;
};

/// What a visitor gets for a Preset; `Model` may be const.
template <typename Model>
struct NoisePreset {
  Model& noise;
};

#define VISMAP_FIELD(name) \
  Field { #name, &Options::name }

inline constexpr auto FieldsOf(const VoxelGridOptions&) {
  using Options = VoxelGridOptions;
  return std::tuple(VISMAP_FIELD(voxel_size_m), VISMAP_FIELD(truncation_voxels));
}

inline constexpr auto FieldsOf(const DepthNoiseModel&) {
  using Options = DepthNoiseModel;
  return std::tuple(VISMAP_FIELD(axial_base_m), VISMAP_FIELD(axial_quadratic_per_m),
                    VISMAP_FIELD(axial_offset_m), VISMAP_FIELD(disparity_step_per_m),
                    VISMAP_FIELD(correlation_px));
}

inline constexpr auto FieldsOf(const SurfaceOptions&) {
  using Options = SurfaceOptions;
  return std::tuple(Preset{"sensor", &Options::noise},  // before the keys that change it
                    Nested{"noise_", &Options::noise}, VISMAP_FIELD(min_depth_m),
                    VISMAP_FIELD(max_depth_m), VISMAP_FIELD(drop_saturated),
                    VISMAP_FIELD(max_hole_px), VISMAP_FIELD(method), VISMAP_FIELD(normal_sigma_deg),
                    VISMAP_FIELD(min_radius_px), VISMAP_FIELD(max_radius_px),
                    VISMAP_FIELD(jump_sigmas), VISMAP_FIELD(max_incidence_deg),
                    VISMAP_FIELD(window_px), VISMAP_FIELD(window_depth_ratio));
}

inline constexpr auto FieldsOf(const SegmentationOptions&) {
  using Options = SegmentationOptions;
  return std::tuple(VISMAP_FIELD(method), VISMAP_FIELD(min_segment_px),
                    VISMAP_FIELD(concave_angle_deg), VISMAP_FIELD(concave_sigmas),
                    VISMAP_FIELD(sharp_angle_deg), VISMAP_FIELD(min_seed_px),
                    VISMAP_FIELD(coplanar_sigmas), VISMAP_FIELD(join_angle_deg),
                    VISMAP_FIELD(depth_ratio), VISMAP_FIELD(concave_tolerance_m),
                    VISMAP_FIELD(concave_cosine), VISMAP_FIELD(convexity_window_px),
                    VISMAP_FIELD(give_back_window_px), VISMAP_FIELD(give_back_distance_m));
}

inline constexpr auto FieldsOf(const RefineOptions&) {
  using Options = RefineOptions;
  return std::tuple(
      VISMAP_FIELD(min_overlap), VISMAP_FIELD(min_score), VISMAP_FIELD(resolve_overlaps),
      VISMAP_FIELD(same_part), VISMAP_FIELD(max_depth_extent), VISMAP_FIELD(take_loose),
      VISMAP_FIELD(loose_depth_extent), VISMAP_FIELD(fold_min_score), VISMAP_FIELD(split),
      VISMAP_FIELD(split_min_score), VISMAP_FIELD(split_min_mask_part), VISMAP_FIELD(split_min_px),
      VISMAP_FIELD(split_min_rest_px), VISMAP_FIELD(leave_out_classes),
      VISMAP_FIELD(leave_out_margin_px));
}

inline constexpr auto FieldsOf(const AssociationOptions&) {
  using Options = AssociationOptions;
  return std::tuple(VISMAP_FIELD(min_overlap_points), VISMAP_FIELD(max_distance_voxels),
                    VISMAP_FIELD(pixel_stride), VISMAP_FIELD(merge_overlap_ratio));
}

inline constexpr auto FieldsOf(const IntegrationOptions&) {
  using Options = IntegrationOptions;
  return std::tuple(
      VISMAP_FIELD(min_range_m), VISMAP_FIELD(max_range_m), VISMAP_FIELD(free_space_range_m),
      VISMAP_FIELD(free_space), VISMAP_FIELD(max_weight), VISMAP_FIELD(max_unpacked_blocks),
      VISMAP_FIELD(vote_distance_voxels), VISMAP_FIELD(merge_frames), VISMAP_FIELD(split_frames),
      VISMAP_FIELD(mask_evidence), VISMAP_FIELD(cut_votes), VISMAP_FIELD(carve_frames),
      VISMAP_FIELD(free_frames), VISMAP_FIELD(carve_keep), VISMAP_FIELD(carve_margin_voxels),
      VISMAP_FIELD(carve_sigmas), VISMAP_FIELD(carve_slope), VISMAP_FIELD(keep_thin),
      VISMAP_FIELD(smooth_radius_px), VISMAP_FIELD(max_map_mb), VISMAP_FIELD(max_frame_blocks));
}

inline constexpr auto FieldsOf(const MeshingOptions&) {
  using Options = MeshingOptions;
  return std::tuple(VISMAP_FIELD(min_weight), VISMAP_FIELD(min_observations),
                    VISMAP_FIELD(jump_fraction), VISMAP_FIELD(min_component_triangles),
                    VISMAP_FIELD(island_max_share), VISMAP_FIELD(island_max_area_m2),
                    VISMAP_FIELD(contact_voxels));
}

inline constexpr auto FieldsOf(const StructureOptions&) {
  using Options = StructureOptions;
  return std::tuple(
      VISMAP_FIELD(structure_flatness_m), VISMAP_FIELD(structure_share),
      VISMAP_FIELD(structure_area_m2), VISMAP_FIELD(table_share), VISMAP_FIELD(table_area_m2),
      VISMAP_FIELD(table_low_m), VISMAP_FIELD(table_high_m), VISMAP_FIELD(ceiling_low_m),
      VISMAP_FIELD(max_tilt_deg), VISMAP_FIELD(flush_roughness), VISMAP_FIELD(flush_gap_m));
}

inline constexpr auto FieldsOf(const ObjectOptions&) {
  using Options = ObjectOptions;
  return std::tuple(VISMAP_FIELD(min_instance_points), VISMAP_FIELD(min_discovered_points),
                    VISMAP_FIELD(min_discovered_frames), VISMAP_FIELD(min_discovered_area_m2),
                    VISMAP_FIELD(min_discovered_fill), VISMAP_FIELD(removed_max_rest),
                    VISMAP_FIELD(removed_max_count), VISMAP_FIELD(removed_max_age_s),
                    VISMAP_FIELD(box_outliers), VISMAP_FIELD(part_gap_m),
                    VISMAP_FIELD(min_part_share), VISMAP_FIELD(min_part_contact),
                    VISMAP_FIELD(max_whole_size_m), VISMAP_FIELD(max_whole_leak),
                    Nested{"", &Options::structure});
}

inline constexpr auto FieldsOf(const OccupancyOptions&) {
  using Options = OccupancyOptions;
  return std::tuple(VISMAP_FIELD(occupied_max_voxels), VISMAP_FIELD(free_min_voxels),
                    VISMAP_FIELD(min_observations), VISMAP_FIELD(thin_hits));
}

inline constexpr auto FieldsOf(const OctreeOptions&) {
  using Options = OctreeOptions;
  return std::tuple(VISMAP_FIELD(resolution_m), VISMAP_FIELD(free_fraction), VISMAP_FIELD(shell_m));
}

inline constexpr auto FieldsOf(const DepthSegmenterOptions&) {
  using Options = DepthSegmenterOptions;
  return std::tuple(VISMAP_FIELD(detections), VISMAP_FIELD(detection_timeout_s),
                    VISMAP_FIELD(max_waiting_frames), VISMAP_FIELD(queue_mb),
                    VISMAP_FIELD(max_wait_s), VISMAP_FIELD(overload));
}

inline constexpr auto FieldsOf(const GroundGridOptions&) {
  using Options = GroundGridOptions;
  return std::tuple(VISMAP_FIELD(resolution_m), VISMAP_FIELD(robot_height_m),
                    VISMAP_FIELD(step_height_m), VISMAP_FIELD(max_slope_deg),
                    VISMAP_FIELD(band_min_m), VISMAP_FIELD(band_max_m),
                    VISMAP_FIELD(distance_limit_m));
}

inline constexpr auto FieldsOf(const MapServerOptions&) {
  using Options = MapServerOptions;
  return std::tuple(VISMAP_FIELD(load), VISMAP_FIELD(save_on_exit), VISMAP_FIELD(save_period_s),
                    VISMAP_FIELD(recover), VISMAP_FIELD(map_folder), VISMAP_FIELD(map_folder_mb),
                    VISMAP_FIELD(mesh_period_s), VISMAP_FIELD(objects_period_s),
                    VISMAP_FIELD(queue_mb), VISMAP_FIELD(max_wait_s), VISMAP_FIELD(overload),
                    VISMAP_FIELD(frame_journal_mb), VISMAP_FIELD(frame_journal),
                    VISMAP_FIELD(accept_corrections), VISMAP_FIELD(checkpoint_frames),
                    VISMAP_FIELD(checkpoint_mb));
}

inline constexpr auto FieldsOf(const OctomapExporterOptions&) {
  using Options = OctomapExporterOptions;
  return std::tuple(VISMAP_FIELD(period_s), VISMAP_FIELD(unknown), VISMAP_FIELD(output_folder),
                    VISMAP_FIELD(max_map_mb), VISMAP_FIELD(coarse_resolution_m),
                    VISMAP_FIELD(repeat_mb_s), VISMAP_FIELD(robot_radius_m),
                    VISMAP_FIELD(grid_period_s), VISMAP_FIELD(distance_limit_m),
                    VISMAP_FIELD(clear_start_m));
}

inline constexpr auto FieldsOf(const ViewerOptions&) {
  using Options = ViewerOptions;
  return std::tuple(VISMAP_FIELD(listen), VISMAP_FIELD(page_folder), VISMAP_FIELD(hosts),
                    VISMAP_FIELD(max_clients), VISMAP_FIELD(budget_mb_s),
                    VISMAP_FIELD(max_picture_hz), VISMAP_FIELD(max_map_mb),
                    VISMAP_FIELD(evidence_mb), VISMAP_FIELD(evidence_hz), VISMAP_FIELD(log_mb),
                    VISMAP_FIELD(log_folder));
}

inline constexpr auto FieldsOf(const SensorReplayOptions&) {
  using Options = SensorReplayOptions;
  return std::tuple(VISMAP_FIELD(lockstep), VISMAP_FIELD(speed), VISMAP_FIELD(window_frames),
                    VISMAP_FIELD(resend_s));
}

inline constexpr auto FieldsOf(const DnnDetectorOptions&) {
  using Options = DnnDetectorOptions;
  return std::tuple(VISMAP_FIELD(model), VISMAP_FIELD(graph), VISMAP_FIELD(kind),
                    VISMAP_FIELD(input_size_px), VISMAP_FIELD(min_score), VISMAP_FIELD(nms_iou),
                    VISMAP_FIELD(mask_threshold), VISMAP_FIELD(max_detections),
                    VISMAP_FIELD(class_names), VISMAP_FIELD(threads));
}

inline constexpr auto FieldsOf(const DetectorOptions&) {
  using Options = DetectorOptions;
  return std::tuple(VISMAP_FIELD(camera_id), VISMAP_FIELD(backend), Nested{"", &Options::dnn},
                    VISMAP_FIELD(every_frame));
}

inline constexpr auto FieldsOf(const HubOptions&) {
  using Options = HubOptions;
  return std::tuple(VISMAP_FIELD(listen), VISMAP_FIELD(queue_mb), VISMAP_FIELD(socket_buffer_bytes),
                    VISMAP_FIELD(max_clients), VISMAP_FIELD(patience_s), VISMAP_FIELD(greeting_s),
                    VISMAP_FIELD(critical), VISMAP_FIELD(rejoin_s), VISMAP_FIELD(max_wait_s),
                    VISMAP_FIELD(max_hold_s), VISMAP_FIELD(total_mb), VISMAP_FIELD(lossless),
                    VISMAP_FIELD(latest), VISMAP_FIELD(drop_newest));
}

inline constexpr auto FieldsOf(const SharedOptions&) {
  using Options = SharedOptions;
  return std::tuple(VISMAP_FIELD(channel_prefix));
}

inline constexpr auto FieldsOf(const BridgeOptions&) {
  using Options = BridgeOptions;
  return std::tuple(VISMAP_FIELD(remote_url), VISMAP_FIELD(send), VISMAP_FIELD(receive),
                    VISMAP_FIELD(queue_mb), VISMAP_FIELD(lossless), VISMAP_FIELD(latest),
                    VISMAP_FIELD(drop_newest));
}

inline constexpr auto FieldsOf(const AdapterCameraOptions&) {
  using Options = AdapterCameraOptions;
  return std::tuple(VISMAP_FIELD(camera_id), VISMAP_FIELD(preset), VISMAP_FIELD(color_channel),
                    VISMAP_FIELD(depth_channel), VISMAP_FIELD(intrinsics_channel),
                    VISMAP_FIELD(depth_intrinsics_channel), VISMAP_FIELD(intrinsics),
                    VISMAP_FIELD(distortion_model), VISMAP_FIELD(distortion),
                    VISMAP_FIELD(swap_red_blue), VISMAP_FIELD(depth_unit_m),
                    VISMAP_FIELD(none_values), VISMAP_FIELD(registered),
                    VISMAP_FIELD(pair_within_ms), VISMAP_FIELD(pose_channels), VISMAP_FIELD(root),
                    VISMAP_FIELD(camera_frame), VISMAP_FIELD(body_frame), VISMAP_FIELD(mounts),
                    VISMAP_FIELD(lookup), VISMAP_FIELD(constant_edges), VISMAP_FIELD(wait_ms),
                    VISMAP_FIELD(max_gap_ms), VISMAP_FIELD(intrinsics_wait_ms), VISMAP_FIELD(time),
                    VISMAP_FIELD(queue_mb));
}

inline constexpr auto FieldsOf(const AdapterOptions& adapter) {
  using Options = AdapterOptions;
  return std::tuple_cat(
      std::tuple(VISMAP_FIELD(robot_url)),
      FieldsOf(static_cast<const AdapterCameraOptions&>(adapter)),
      std::tuple(VISMAP_FIELD(publish_period_s), VISMAP_FIELD(cloud_channel),
                 VISMAP_FIELD(cloud_spacing_m), VISMAP_FIELD(costmap_channel),
                 VISMAP_FIELD(costmap_resolution_m), VISMAP_FIELD(costmap_min_z_m),
                 VISMAP_FIELD(costmap_max_z_m), VISMAP_FIELD(costmap_unknown),
                 VISMAP_FIELD(detections_channel), VISMAP_FIELD(drake_cloud_channel),
                 VISMAP_FIELD(drake_objects_channel), VISMAP_FIELD(director_channel),
                 VISMAP_FIELD(camera)));  // begins with the keys before it
}

/// The sections of a config file.
inline constexpr auto FieldsOf(const VismapConfig&) {
  using Options = VismapConfig;
  return std::tuple(VISMAP_FIELD(grid), VISMAP_FIELD(surface), VISMAP_FIELD(segmentation),
                    VISMAP_FIELD(refine), VISMAP_FIELD(association), VISMAP_FIELD(integration),
                    VISMAP_FIELD(meshing), VISMAP_FIELD(objects), VISMAP_FIELD(free_space),
                    VISMAP_FIELD(octree), VISMAP_FIELD(depth_segmenter), VISMAP_FIELD(map_server),
                    VISMAP_FIELD(octomap_exporter), VISMAP_FIELD(viewer),
                    VISMAP_FIELD(sensor_replay), VISMAP_FIELD(detector), VISMAP_FIELD(hub),
                    VISMAP_FIELD(bridge), VISMAP_FIELD(adapter), VISMAP_FIELD(ground_grid),
                    VISMAP_FIELD(pipeline));
}

#undef VISMAP_FIELD

/// Calls visit(key, member) for each key that `options` hold. Options may be const.
template <typename Options, typename Visit>
void ForEachKey(Options& options, const std::string& prefix, const Visit& visit);

template <typename Options, typename Owner, typename Member, typename Visit>
void VisitEntry(Options& options, const Field<Owner, Member>& field, const std::string& prefix,
                const Visit& visit) {
  visit(prefix + field.key, options.*field.member);
}

template <typename Options, typename Owner, typename Member, typename Visit>
void VisitEntry(Options& options, const Nested<Owner, Member>& nested, const std::string& prefix,
                const Visit& visit) {
  ForEachKey(options.*nested.member, prefix + nested.prefix, visit);
}

template <typename Options, typename Owner, typename Visit>
void VisitEntry(Options& options, const Preset<Owner>& preset, const std::string& prefix,
                const Visit& visit) {
  visit(prefix + preset.key, NoisePreset{options.*preset.member});
}

template <typename Options, typename Visit>
void ForEachKey(Options& options, const std::string& prefix, const Visit& visit) {
  std::apply([&](const auto&... entries) { (VisitEntry(options, entries, prefix, visit), ...); },
             FieldsOf(options));
}

/// Calls visit(section, key, member) for each key of a config file. Config may be const.
template <typename Config, typename Visit>
void ForEachKey(Config& config, const Visit& visit) {
  const auto visit_section = [&](const auto& section) {
    ForEachKey(config.*section.member, "",
               [&](const std::string& key, auto&& member) { visit(section.key, key, member); });
  };
  std::apply([&](const auto&... sections) { (visit_section(sections), ...); }, FieldsOf(config));
  visit("objects", std::string("up_W"),
        config.up_W);  // the one that is not in its section's struct
}

}  // namespace vismap::config
