#include "objects/read_out.h"

#include <algorithm>

namespace vismap {
namespace {

double SizeOf(SegmentLabel label, std::span<const double> sizes) {
  if (sizes.empty()) return 1;
  return Raw(label) < sizes.size() ? sizes[Raw(label)] : 0;
}

// Whether a label confirms an instance. One frame gives at most 1 (score times overlap), so
// evidence above 1 comes from several frames. Less evidence is enough if it is at least a quarter
// of the frames with a detector that observed the label, as for a label that has been observed only
// a few times.
bool Confirms(const LabelRecord& record, InstanceId instance) {
  constexpr float kOfOneFrame = 1, kLeastShare = 0.25F;
  const auto found = record.instance_evidence.find(instance);
  if (found == record.instance_evidence.end()) return false;
  return found->second > kOfOneFrame ||
         found->second >= kLeastShare * static_cast<float>(record.frames_with_detector);
}

// Erases the instances that none of their labels confirms.
void EraseUnconfirmed(const LabelTable& table, LabelReadOut* read_out) {
  std::erase_if(read_out->instances, [&](const auto& entry) {
    const auto& [id, instance] = entry;
    const auto confirms = [&](SegmentLabel label) { return Confirms(table.Record(label), id); };
    if (std::any_of(instance.labels.begin(), instance.labels.end(), confirms)) return false;
    for (const SegmentLabel label : instance.labels) read_out->labels[Raw(label)] = {};
    return true;
  });
}

// Turns the sums of evidence into shares, and sets the class with the largest one.
void Normalise(InstanceReading* reading) {
  std::erase_if(reading->class_probability, [](const auto& entry) { return !(entry.second > 0); });
  double sum = 0, most = 0;
  for (const auto& [class_id, evidence] : reading->class_probability) {
    sum += evidence;
    if (evidence > most) reading->class_id = class_id;
    most = std::max(most, evidence);
  }
  for (auto& [class_id, evidence] : reading->class_probability) evidence /= sum;
}

}  // namespace

LabelReadOut ReadLabels(const LabelTable& table, std::span<const double> sizes) {
  LabelReadOut read_out;
  read_out.labels.resize(Raw(table.next_label()));
  for (const SegmentLabel label : table.Alive()) {
    const LabelReading reading = table.Read(label);
    read_out.labels[Raw(label)] = reading;
    if (reading.instance == InstanceId::kNone) continue;
    InstanceReading& instance = read_out.instances[reading.instance];
    instance.labels.push_back(label);
    for (const auto& [class_id, evidence] : table.Record(label).class_evidence) {
      if (class_id == ClassId::kUnknown) continue;
      instance.class_probability[class_id] += static_cast<double>(evidence) * SizeOf(label, sizes);
    }
  }
  EraseUnconfirmed(table, &read_out);
  for (auto& [id, instance] : read_out.instances) Normalise(&instance);
  return read_out;
}

std::vector<ShownLabel> ShowLabels(const LabelTable& table) {
  const LabelReadOut read_out = ReadLabels(table);
  std::vector<ShownLabel> shown = ShowSegments(table);
  for (ShownLabel& label : shown) {
    label.instance = read_out.labels[Raw(label.segment)].instance;
    const auto known = read_out.instances.find(label.instance);
    if (known != read_out.instances.end()) label.class_id = known->second.class_id;
  }
  return shown;
}

std::vector<double> VerticesPerLabel(const Mesh& mesh) {
  std::vector<double> counts(1, 0);
  for (const MeshVertex& vertex : mesh.vertices) {
    const size_t label = Raw(vertex.segment);
    if (label >= counts.size()) counts.resize(label + 1, 0);
    ++counts[label];
  }
  counts[0] = 0;
  return counts;
}

void ApplyReadOut(const LabelReadOut& read_out, Mesh* mesh) {
  std::vector<ClassId> classes(read_out.labels.size(), ClassId::kUnknown);
  for (const auto& [id, instance] : read_out.instances) {
    for (const SegmentLabel label : instance.labels) classes[Raw(label)] = instance.class_id;
  }
  for (MeshVertex& vertex : mesh->vertices) {
    const size_t label = Raw(vertex.segment);
    const bool known = label < read_out.labels.size();
    vertex.instance = known ? read_out.labels[label].instance : InstanceId::kNone;
    vertex.class_id = known ? classes[label] : ClassId::kUnknown;
  }
}

}  // namespace vismap
