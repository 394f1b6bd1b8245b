#include "exports/statistics.h"

#include <nlohmann/json.hpp>

namespace vismap {

std::string StatisticsJson(const SemanticMap& map, const MapMetadata& metadata) {
  const VoxelMapMemory memory = MeasureMemory(map.voxels);
  nlohmann::ordered_json json;
  json["map_id"] = metadata.map_id;
  json["hash"] = HashMap(map);
  json["revision"] = map.revision;
  json["voxel_size_m"] = map.voxels.voxel_size();
  json["truncation_m"] = map.voxels.truncation();
  json["frames"] = metadata.trajectory.size();
  json["last_utime"] = map.last_utime;
  json["blocks"] = map.voxels.size();
  json["blocks_surface"] = memory.surface_blocks;
  json["blocks_packed"] = memory.packed_blocks;
  json["blocks_partly_free"] = memory.free_blocks;
  json["blocks_free"] = memory.all_free_blocks;
  json["bytes"] = memory.total_bytes();
  json["bytes_tsdf"] = memory.tsdf_bytes;
  json["bytes_color"] = memory.color_bytes;
  json["bytes_labels"] = memory.label_bytes;
  json["bytes_packed"] = memory.packed_bytes;
  json["bytes_free_space"] = memory.free_bytes;
  json["bytes_table"] = memory.table_bytes;
  json["segments"] = map.labels.Alive().size();
  json["segments_ever"] = map.labels.records().size();
  json["instances"] = map.labels.InstanceClasses().size();
  json["instances_ever"] = Raw(map.labels.next_instance()) - 1;
  return json.dump();
}

}  // namespace vismap
