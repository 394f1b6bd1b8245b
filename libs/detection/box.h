#pragma once

#include <vector>

namespace vismap {

/// A rectangle of an image [px] by its edges. Pixel (u, v) covers [u, u + 1) x [v, v + 1), as
/// networks count: in this room only, elsewhere pixel centres are integers.
struct Box {
  float u0 = 0, v0 = 0, u1 = 0, v1 = 0;
};

/// Area of what two boxes share over that of what they cover together; 0 when they cover nothing.
float Overlap(const Box& a, const Box& b);

/// What a network takes for an object, before its mask is made.
struct Candidate {
  int class_index = 0;  ///< as the network counts, from 0
  float score = 0;      ///< [0, 1]
  Box box;
  int source = 0;  ///< which row of the network's output it came from
};

/// The candidates without those that overlap a stronger one of their class by more than `max_iou`,
/// strongest first, at most `max_count`. Of equal scores the one with the lower source is stronger.
std::vector<Candidate> SuppressOverlaps(std::vector<Candidate> candidates, float max_iou,
                                        int max_count);

}  // namespace vismap
