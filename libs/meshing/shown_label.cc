#include "meshing/shown_label.h"

namespace vismap {

std::vector<ShownLabel> ShowSegments(const LabelTable& table) {
  std::vector<ShownLabel> shown(Raw(table.next_label()));
  for (size_t i = 0; i < shown.size(); ++i)
    shown[i].segment = table.Canonical(static_cast<SegmentLabel>(i));
  return shown;
}

}  // namespace vismap
