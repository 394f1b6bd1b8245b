#include "map_server/map_memory.h"

#include <nlohmann/json.hpp>

#include "map/map_bytes.h"

namespace vismap {

std::vector<MemoryLayer> MeasureLayers(const MapSession& session, MapPublisher& publisher,
                                       size_t copies) {
  const SemanticMap& map = session.map();
  const VoxelMapMemory voxels = MeasureMemory(map.voxels);
  const size_t labels = BytesOf(map.labels), trajectory = TrajectoryBytes(map.revision);
  constexpr size_t kObject = 1024;  // its segments, classes and boxes, in three lists
  return {{"distances", voxels.tsdf_bytes},
          {"colours", voxels.color_bytes},
          {"labels", voxels.label_bytes + labels},
          {"packed", voxels.packed_bytes},
          {"spare", SpareVoxelBytes()},
          {"free_space", voxels.free_bytes},
          {"table", voxels.table_bytes},
          {"surface", publisher.mesh().tracker().bytes()},
          {"occupancy", publisher.occupancy().bytes()},
          {"objects", publisher.objects().objects().size() * kObject},
          {"trajectory", trajectory},
          {"copies", copies * (voxels.table_bytes + labels)}};
}

nlohmann::ordered_json ToJson(const std::vector<MemoryLayer>& layers) {
  nlohmann::ordered_json json;
  for (const MemoryLayer& layer : layers) json[layer.name] = layer.bytes;
  return json;
}

}  // namespace vismap
