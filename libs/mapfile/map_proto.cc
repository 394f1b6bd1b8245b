#include "mapfile/map_proto.h"

#include <cmath>
#include <limits>

#include "map.pb.h"

namespace vismap::mapfile {
namespace {

/// A table of evidence as two parallel lists.
template <typename Id, typename Ids, typename Amounts>
void PutEvidence(const std::map<Id, float>& evidence, Ids* ids, Amounts* amounts) {
  for (const auto& [id, amount] : evidence) {
    ids->Add(Raw(id));
    amounts->Add(amount);
  }
}

template <typename Id, typename Ids, typename Amounts>
Result<std::map<Id, float>> ParseEvidence(const Ids& ids, const Amounts& amounts) {
  if (ids.size() != amounts.size()) return Fail("the number of ids and of their evidence differ");
  std::map<Id, float> evidence;
  for (int i = 0; i < ids.size(); ++i) {
    if (ids[i] > std::numeric_limits<std::underlying_type_t<Id>>::max()) {
      return Fail("an id of evidence is out of range");
    }
    if (i > 0 && ids[i - 1] >= ids[i]) return Fail("ids of evidence are not ascending");
    if (!std::isfinite(amounts[i])) return Fail("evidence is not a finite number");
    evidence.emplace_hint(evidence.end(), static_cast<Id>(ids[i]), amounts[i]);
  }
  return evidence;
}

void PutRecord(const vismap::LabelRecord& record, LabelRecord* proto) {
  proto->set_merged_into(Raw(record.merged_into));
  proto->set_frames(record.frames);
  proto->set_frames_with_detector(record.frames_with_detector);
  proto->set_pixels(record.pixels);
  proto->set_first_utime(record.first_utime);
  proto->set_last_utime(record.last_utime);
  proto->set_cleared_voxels(record.cleared_voxels);
  proto->set_cleared_utime(record.cleared_utime);
  PutEvidence(record.instance_evidence, proto->mutable_instances(),
              proto->mutable_instance_evidence());
  PutEvidence(record.class_evidence, proto->mutable_classes(), proto->mutable_class_evidence());
}

/// `label`: the label of the record. A label is merged only into a lower one, so that following the
/// merges ends.
Result<vismap::LabelRecord> ParseRecord(const LabelRecord& proto, size_t label) {
  vismap::LabelRecord record;
  if (proto.merged_into() >= label) return Fail("merged into a higher label");
  record.merged_into = static_cast<SegmentLabel>(proto.merged_into());
  record.frames = proto.frames();
  record.frames_with_detector = proto.frames_with_detector();
  record.pixels = proto.pixels();
  record.first_utime = proto.first_utime();
  record.last_utime = proto.last_utime();
  record.cleared_voxels = proto.cleared_voxels();
  record.cleared_utime = proto.cleared_utime();
  auto instances = ParseEvidence<InstanceId>(proto.instances(), proto.instance_evidence());
  if (!instances) return tl::unexpected(instances.error());
  record.instance_evidence = std::move(*instances);
  auto classes = ParseEvidence<ClassId>(proto.classes(), proto.class_evidence());
  if (!classes) return tl::unexpected(classes.error());
  record.class_evidence = std::move(*classes);
  return record;
}

using PairMap = std::map<std::pair<SegmentLabel, SegmentLabel>, PairEvidence>;

bool IsAlive(uint32_t label, const Labels& proto) {
  return label >= 1 && label <= static_cast<uint32_t>(proto.records_size()) &&
         proto.records(static_cast<int>(label - 1)).merged_into() == 0;
}

/// The labels of a Pair or Bond: alive, the smaller first.
template <typename TwoLabels>
Result<std::pair<SegmentLabel, SegmentLabel>> ParseKey(const TwoLabels& two, const Labels& proto) {
  if (two.first() >= two.second() || !IsAlive(two.first(), proto) ||
      !IsAlive(two.second(), proto)) {
    return Fail("labels " + std::to_string(two.first()) + " and " + std::to_string(two.second()) +
                " are not a pair of alive labels in ascending order");
  }
  return std::pair{static_cast<SegmentLabel>(two.first()), static_cast<SegmentLabel>(two.second())};
}

Result<PairMap> ParsePairs(const Labels& proto) {
  PairMap pairs;
  for (const Pair& pair : proto.pairs()) {
    const auto key = ParseKey(pair, proto);
    if (!key) return tl::unexpected(key.error());
    if (!std::isfinite(pair.together()) || !std::isfinite(pair.apart())) {
      return Fail("evidence of a pair is not a finite number");
    }
    if (!pairs.empty() && !(pairs.rbegin()->first < *key)) return Fail("pairs are not ascending");
    pairs.emplace_hint(pairs.end(), *key, PairEvidence{pair.together(), pair.apart()});
  }
  return pairs;
}

Result<MaskBonds> ParseBonds(const Labels& proto) {
  std::map<MaskBonds::Pair, float> bonds;
  for (const Bond& bond : proto.bonds()) {
    const auto key = ParseKey(bond, proto);
    if (!key) return tl::unexpected(key.error());
    if (!(std::abs(bond.bond()) <= MaskBonds::kMost)) return Fail("a bond is out of range");
    if (!bonds.empty() && !(bonds.rbegin()->first < *key)) return Fail("bonds are not ascending");
    bonds.emplace_hint(bonds.end(), *key, bond.bond());
  }
  return MaskBonds::Restore(std::move(bonds));
}

void PutPose(const vismap::CameraPose& pose, CameraPose* proto) {
  proto->set_utime(pose.utime);
  proto->set_camera_id(Raw(pose.camera_id));
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) proto->add_t_w_c(pose.T_W_C(row, column));
  }
}

Result<vismap::CameraPose> ParsePose(const CameraPose& proto) {
  if (proto.t_w_c_size() != 12) return Fail("a pose does not have 12 numbers");
  vismap::CameraPose pose;
  pose.utime = proto.utime();
  pose.camera_id = static_cast<CameraId>(proto.camera_id());
  for (int i = 0; i < 12; ++i) {
    if (!std::isfinite(proto.t_w_c(i))) return Fail("a pose is not finite");
    pose.T_W_C(i / 4, i % 4) = proto.t_w_c(i);
  }
  return pose;
}

Result<VoxelGridOptions> ParseGrid(const Header& proto) {
  const VoxelGridOptions grid{proto.voxel_size_m(), proto.truncation_voxels()};
  if (!(grid.voxel_size_m > 1e-4 && grid.voxel_size_m < 10)) {
    return Fail("the voxel size is not a plausible length");
  }
  if (!(grid.truncation_voxels >= 1 && grid.truncation_voxels < 1000)) {
    return Fail("the truncation distance is not a plausible number of voxels");
  }
  return grid;
}

Result<Eigen::Vector3d> ParseCamera(const Header& proto) {
  if (proto.last_camera_w_m_size() != 3)
    return Fail("the last camera position does not have 3 coordinates");
  const Eigen::Vector3d camera_W(proto.last_camera_w_m(0), proto.last_camera_w_m(1),
                                 proto.last_camera_w_m(2));
  if (!camera_W.allFinite()) return Fail("the last camera position is not finite");
  return camera_W;
}

Result<MapMetadata> ParseMetadata(const Header& proto) {
  MapMetadata metadata;
  metadata.map_id = proto.map_id();
  metadata.config = proto.config();
  metadata.created_by = proto.created_by();
  for (const ClassName& name : proto.class_names()) {
    if (name.class_id() > std::numeric_limits<uint16_t>::max()) {
      return Fail("class id " + std::to_string(name.class_id()) + " is out of range");
    }
    metadata.class_names[static_cast<ClassId>(name.class_id())] = name.name();
  }
  for (const CameraPose& proto_pose : proto.trajectory()) {
    Result<vismap::CameraPose> pose = ParsePose(proto_pose);
    if (!pose) return tl::unexpected(pose.error());
    metadata.trajectory.push_back(*pose);
  }
  return metadata;
}

}  // namespace

void ToProto(const SemanticMap& map, const MapMetadata& metadata, Header* proto) {
  proto->set_voxel_size_m(map.voxels.options().voxel_size_m);
  proto->set_truncation_voxels(map.voxels.options().truncation_voxels);
  proto->set_revision(map.revision);
  proto->set_last_utime(map.last_utime);
  for (const double coordinate : map.last_camera_W) proto->add_last_camera_w_m(coordinate);
  proto->set_map_id(metadata.map_id);
  proto->set_config(metadata.config);
  proto->set_created_by(metadata.created_by);
  for (const auto& [class_id, name] : metadata.class_names) {
    ClassName* class_name = proto->add_class_names();
    class_name->set_class_id(Raw(class_id));
    class_name->set_name(name);
  }
  for (const vismap::CameraPose& pose : metadata.trajectory) PutPose(pose, proto->add_trajectory());
}

void ToProto(const LabelTable& labels, Labels* proto) {
  for (const vismap::LabelRecord& record : labels.records()) {
    PutRecord(record, proto->add_records());
  }
  proto->set_next_instance(Raw(labels.next_instance()));
  for (const auto& [key, evidence] : labels.pairs()) {
    Pair* pair = proto->add_pairs();
    pair->set_first(Raw(key.first));
    pair->set_second(Raw(key.second));
    pair->set_together(evidence.together);
    pair->set_apart(evidence.apart);
  }
  for (const auto& [key, amount] : labels.bonds().pairs()) {
    Bond* bond = proto->add_bonds();
    bond->set_first(Raw(key.first));
    bond->set_second(Raw(key.second));
    bond->set_bond(amount);
  }
  proto->set_min_instance_ratio(labels.min_instance_ratio);
}

Result<LoadedMap> FromProto(const Header& proto) {
  const Result<VoxelGridOptions> grid = ParseGrid(proto);
  if (!grid) return tl::unexpected(grid.error());
  const Result<Eigen::Vector3d> camera_W = ParseCamera(proto);
  if (!camera_W) return tl::unexpected(camera_W.error());
  Result<MapMetadata> metadata = ParseMetadata(proto);
  if (!metadata) return tl::unexpected(metadata.error());
  LoadedMap loaded{SemanticMap(*grid), std::move(*metadata), {}};
  loaded.map.revision = proto.revision();
  loaded.map.last_utime = proto.last_utime();
  loaded.map.last_camera_W = *camera_W;
  return loaded;
}

Result<LabelTable> FromProto(const Labels& proto) {
  std::vector<vismap::LabelRecord> records;
  for (const LabelRecord& proto_record : proto.records()) {
    const size_t label = records.size() + 1;
    Result<vismap::LabelRecord> record = ParseRecord(proto_record, label);
    if (!record) {
      return Fail("segment label " + std::to_string(label) + ": " + record.error().message);
    }
    records.push_back(std::move(*record));
  }
  Result<PairMap> pairs = ParsePairs(proto);
  if (!pairs) return tl::unexpected(pairs.error());
  Result<MaskBonds> bonds = ParseBonds(proto);
  if (!bonds) return tl::unexpected(bonds.error());
  if (!std::isfinite(proto.min_instance_ratio())) return Fail("min_instance_ratio is not finite");
  LabelTable labels =
      LabelTable::Restore(std::move(records), static_cast<InstanceId>(proto.next_instance()),
                          std::move(*pairs), std::move(*bonds));
  labels.min_instance_ratio = proto.min_instance_ratio();
  return labels;
}

}  // namespace vismap::mapfile
