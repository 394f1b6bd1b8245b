#include "plausibility/sequence_check.h"

#include <optional>

namespace vismap {

void SequenceCheck::Add(const SegmentedFrame& frame) {
  poses_.Add(frame.frame.header, frame.frame.depth);
  depth_.Add(frame);
}

std::vector<std::string> SequenceCheck::Findings() const {
  std::vector<std::string> findings;
  for (const std::optional<std::string>& finding :
       {depth_.RangeFinding(depth_unit_m_), poses_.Finding(), depth_.SegmentFinding()}) {
    if (finding) findings.push_back(*finding);
  }
  return findings;
}

}  // namespace vismap
