#pragma once

#include "config/config.h"

namespace vismap::config {

// Which key of options.proto is which member of an option struct: said once here, for reading and
// for writing. A binder has
//   Value(key, member)        for double, int, bool, std::string, enums (same order in both) and
//                             lists of strings,
//   Classes(key, member)      for lists of classes, by COCO name or number,
//   Direction(key, member)    for three numbers of unit length or none,
//   Sensor(key, noise model)  for the presets of noise models,
//   Section(key, body)        for a message; calls body(binder of the message).

template <typename Binder>
void BindSurface(Binder& bind, SurfaceOptions& options) {
  bind.Sensor("sensor", options.noise);  // before the fields that change it
  bind.Value("noise_axial_base_m", options.noise.axial_base_m);
  bind.Value("noise_axial_quadratic_per_m", options.noise.axial_quadratic_per_m);
  bind.Value("noise_axial_offset_m", options.noise.axial_offset_m);
  bind.Value("noise_disparity_step_per_m", options.noise.disparity_step_per_m);
  bind.Value("noise_correlation_px", options.noise.correlation_px);
  bind.Value("min_depth_m", options.min_depth_m);
  bind.Value("max_depth_m", options.max_depth_m);
  bind.Value("method", options.method);
  bind.Value("normal_sigma_deg", options.normal_sigma_deg);
  bind.Value("min_radius_px", options.min_radius_px);
  bind.Value("max_radius_px", options.max_radius_px);
  bind.Value("jump_sigmas", options.jump_sigmas);
  bind.Value("max_incidence_deg", options.max_incidence_deg);
  bind.Value("window_px", options.window_px);
  bind.Value("window_depth_ratio", options.window_depth_ratio);
}

template <typename Binder>
void BindSegmentation(Binder& bind, SegmentationOptions& options) {
  bind.Value("method", options.method);
  bind.Value("min_segment_px", options.min_segment_px);
  bind.Value("concave_angle_deg", options.concave_angle_deg);
  bind.Value("concave_sigmas", options.concave_sigmas);
  bind.Value("sharp_angle_deg", options.sharp_angle_deg);
  bind.Value("min_seed_px", options.min_seed_px);
  bind.Value("coplanar_sigmas", options.coplanar_sigmas);
  bind.Value("join_angle_deg", options.join_angle_deg);
  bind.Value("depth_ratio", options.depth_ratio);
  bind.Value("concave_tolerance_m", options.concave_tolerance_m);
  bind.Value("concave_cosine", options.concave_cosine);
  bind.Value("convexity_window_px", options.convexity_window_px);
  bind.Value("give_back_window_px", options.give_back_window_px);
  bind.Value("give_back_distance_m", options.give_back_distance_m);
}

template <typename Binder>
void BindRefine(Binder& bind, RefineOptions& options) {
  bind.Value("min_overlap", options.min_overlap);
  bind.Value("min_score", options.min_score);
  bind.Value("resolve_overlaps", options.resolve_overlaps);
  bind.Value("same_part", options.same_part);
  bind.Value("max_depth_extent", options.max_depth_extent);
  bind.Value("take_loose", options.take_loose);
  bind.Value("loose_depth_extent", options.loose_depth_extent);
  bind.Value("fold_min_score", options.fold_min_score);
  bind.Value("split", options.split);
  bind.Value("split_min_score", options.split_min_score);
  bind.Value("split_min_mask_part", options.split_min_mask_part);
  bind.Value("split_min_px", options.split_min_px);
  bind.Value("split_min_rest_px", options.split_min_rest_px);
  bind.Classes("leave_out_classes", options.leave_out_classes);
  bind.Value("leave_out_margin_px", options.leave_out_margin_px);
}

template <typename Binder>
void BindAssociation(Binder& bind, AssociationOptions& options) {
  bind.Value("min_overlap_points", options.min_overlap_points);
  bind.Value("max_distance_voxels", options.max_distance_voxels);
  bind.Value("pixel_stride", options.pixel_stride);
  bind.Value("merge_overlap_ratio", options.merge_overlap_ratio);
}

template <typename Binder>
void BindIntegration(Binder& bind, IntegrationOptions& options) {
  bind.Value("min_range_m", options.min_range_m);
  bind.Value("max_range_m", options.max_range_m);
  bind.Value("free_space_range_m", options.free_space_range_m);
  bind.Value("free_space", options.free_space);
  bind.Value("max_weight", options.max_weight);
  bind.Value("max_unpacked_blocks", options.max_unpacked_blocks);
  bind.Value("vote_distance_voxels", options.vote_distance_voxels);
  bind.Value("merge_frames", options.merge_frames);
  bind.Value("split_frames", options.split_frames);
  bind.Value("mask_evidence", options.mask_evidence);
  bind.Value("cut_votes", options.cut_votes);
  bind.Value("carve_frames", options.carve_frames);
  bind.Value("free_frames", options.free_frames);
  bind.Value("carve_keep", options.carve_keep);
  bind.Value("carve_margin_voxels", options.carve_margin_voxels);
  bind.Value("carve_sigmas", options.carve_sigmas);
  bind.Value("carve_slope", options.carve_slope);
}

template <typename Binder>
void BindMeshing(Binder& bind, MeshingOptions& options) {
  bind.Value("min_weight", options.min_weight);
  bind.Value("min_observations", options.min_observations);
  bind.Value("jump_fraction", options.jump_fraction);
  bind.Value("min_component_triangles", options.min_component_triangles);
  bind.Value("island_max_share", options.island_max_share);
  bind.Value("island_max_area_m2", options.island_max_area_m2);
  bind.Value("contact_voxels", options.contact_voxels);
}

template <typename Binder>
void BindObjects(Binder& bind, VismapConfig& config) {
  ObjectOptions& options = config.objects;
  bind.Direction("up_W", config.up_W);
  bind.Value("min_instance_points", options.min_instance_points);
  bind.Value("min_discovered_points", options.min_discovered_points);
  bind.Value("min_discovered_frames", options.min_discovered_frames);
  bind.Value("min_discovered_area_m2", options.min_discovered_area_m2);
  bind.Value("min_discovered_fill", options.min_discovered_fill);
  bind.Value("removed_max_rest", options.removed_max_rest);
  bind.Value("removed_max_count", options.removed_max_count);
  bind.Value("removed_max_age_s", options.removed_max_age_s);
  bind.Value("box_outliers", options.box_outliers);
  bind.Value("part_gap_m", options.part_gap_m);
  bind.Value("min_part_share", options.min_part_share);
  bind.Value("structure_flatness_m", options.structure.structure_flatness_m);
  bind.Value("structure_share", options.structure.structure_share);
  bind.Value("structure_area_m2", options.structure.structure_area_m2);
  bind.Value("table_share", options.structure.table_share);
  bind.Value("table_area_m2", options.structure.table_area_m2);
  bind.Value("table_low_m", options.structure.table_low_m);
  bind.Value("table_high_m", options.structure.table_high_m);
  bind.Value("ceiling_low_m", options.structure.ceiling_low_m);
  bind.Value("max_tilt_deg", options.structure.max_tilt_deg);
  bind.Value("flush_roughness", options.structure.flush_roughness);
  bind.Value("flush_gap_m", options.structure.flush_gap_m);
}

template <typename Binder>
void BindFreeSpace(Binder& bind, OccupancyOptions& options) {
  bind.Value("occupied_max_voxels", options.occupied_max_voxels);
  bind.Value("free_min_voxels", options.free_min_voxels);
  bind.Value("min_observations", options.min_observations);
}

template <typename Binder>
void BindDepthSegmenter(Binder& bind, DepthSegmenterConfig& config) {
  bind.Value("detections", config.detections);
  bind.Value("detection_timeout_s", config.detection_timeout_s);
  bind.Value("max_waiting_frames", config.max_waiting_frames);
}

template <typename Binder>
void BindSensorReplay(Binder& bind, SensorReplayConfig& config) {
  bind.Value("lockstep", config.lockstep);
  bind.Value("speed", config.speed);
  bind.Value("window_frames", config.window);
  bind.Value("resend_s", config.resend_after);
}

template <typename Binder>
void BindDetector(Binder& bind, DetectorConfig& config) {
  bind.Value("camera_id", config.camera_id);
  bind.Value("backend", config.backend);
  bind.Value("model", config.dnn.model);
  bind.Value("graph", config.dnn.graph);
  bind.Value("kind", config.dnn.kind);
  bind.Value("input_size_px", config.dnn.input_size_px);
  bind.Value("min_score", config.dnn.min_score);
  bind.Value("nms_iou", config.dnn.nms_iou);
  bind.Value("mask_threshold", config.dnn.mask_threshold);
  bind.Value("max_detections", config.dnn.max_detections);
  bind.Value("class_names", config.dnn.class_names);
  bind.Value("threads", config.dnn.threads);
  bind.Value("every_frame", config.every_frame);
}

template <typename Binder>
void BindHub(Binder& bind, HubConfig& config) {
  bind.Value("listen", config.listen);
  bind.Value("queue_mb", config.queue_mb);
  bind.Value("socket_buffer_bytes", config.socket_buffer_bytes);
  bind.Value("max_clients", config.max_clients);
  bind.Value("patience_s", config.patience);
  bind.Value("lossless", config.lossless);
  bind.Value("latest", config.latest);
  bind.Value("drop_newest", config.drop_newest);
}

template <typename Binder>
void BindBridge(Binder& bind, BridgeConfig& config) {
  bind.Value("remote_url", config.remote_url);
  bind.Value("send", config.send);
  bind.Value("receive", config.receive);
  bind.Value("queue_mb", config.queue_mb);
  bind.Value("lossless", config.lossless);
  bind.Value("latest", config.latest);
  bind.Value("drop_newest", config.drop_newest);
}

template <typename Binder>
void BindMapServer(Binder& bind, MapServerConfig& config) {
  bind.Value("load", config.load);
  bind.Value("save_on_exit", config.save_on_exit);
  bind.Value("save_period_s", config.save_period_s);
  bind.Value("mesh_period_s", config.mesh_period_s);
  bind.Value("objects_period_s", config.objects_period_s);
  bind.Value("recover", config.recover);
}

template <typename Binder>
void BindOctomapExporter(Binder& bind, OctomapExporterConfig& config) {
  bind.Value("period_s", config.period);
  bind.Value("unknown", config.unknown);
  bind.Value("output_folder", config.output_folder);
}

template <typename Binder>
void BindConfig(Binder& bind, VismapConfig& config) {
  bind.Section("grid", [&](Binder& grid) {
    grid.Value("voxel_size_m", config.grid.voxel_size_m);
    grid.Value("truncation_voxels", config.grid.truncation_voxels);
  });
  bind.Section("surface", [&](Binder& at) { BindSurface(at, config.segmentation.surface); });
  bind.Section("segmentation",
               [&](Binder& at) { BindSegmentation(at, config.segmentation.segmentation); });
  bind.Section("refine", [&](Binder& at) { BindRefine(at, config.segmentation.refine); });
  bind.Section("association", [&](Binder& at) { BindAssociation(at, config.association); });
  bind.Section("integration", [&](Binder& at) { BindIntegration(at, config.integration); });
  bind.Section("meshing", [&](Binder& at) { BindMeshing(at, config.meshing); });
  bind.Section("objects", [&](Binder& at) { BindObjects(at, config); });
  bind.Section("free_space", [&](Binder& at) { BindFreeSpace(at, config.free_space); });
  bind.Section("octree", [&](Binder& octree) {
    octree.Value("resolution_m", config.octree.resolution_m);
    octree.Value("free_fraction", config.octree.free_fraction);
  });
  bind.Section("depth_segmenter",
               [&](Binder& at) { BindDepthSegmenter(at, config.depth_segmenter); });
  bind.Section("map_server", [&](Binder& at) { BindMapServer(at, config.map_server); });
  bind.Section("octomap_exporter",
               [&](Binder& at) { BindOctomapExporter(at, config.octomap_exporter); });
  bind.Section("sensor_replay", [&](Binder& at) { BindSensorReplay(at, config.sensor_replay); });
  bind.Section("detector", [&](Binder& at) { BindDetector(at, config.detector); });
  bind.Section("hub", [&](Binder& at) { BindHub(at, config.hub); });
  bind.Section("bridge", [&](Binder& at) { BindBridge(at, config.bridge); });
}

}  // namespace vismap::config
