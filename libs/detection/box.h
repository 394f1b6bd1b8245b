#pragma once

#include <vector>

namespace vismap {

/// A rectangle of an image, given by its edges [px]. Pixel (u, v) covers [u, u + 1) x [v, v + 1),
/// as in networks. This convention is used only in this room; elsewhere, pixel centres are
/// integers.
struct Box {
  float u0 = 0, v0 = 0, u1 = 0, v1 = 0;
};

/// Intersection over union of two boxes; 0 if both are empty.
float Overlap(const Box& a, const Box& b);

/// An object that a network has found, before its mask is computed.
struct Candidate {
  int class_index = 0;  ///< class number of the network, from 0
  float score = 0;      ///< [0, 1]
  Box box;
  int source = 0;  ///< its row in the network's output
};

/// Non-maximum suppression: drops each candidate whose IoU with a kept candidate of the same class
/// and a higher score is above `max_iou`. Returns at most `max_count`, highest score first; ties go
/// to the lower source.
std::vector<Candidate> SuppressOverlaps(std::vector<Candidate> candidates, float max_iou,
                                        int max_count);

}  // namespace vismap
