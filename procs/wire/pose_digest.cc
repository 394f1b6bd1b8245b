#include "wire/pose_digest.h"

#include "base/digest.h"

namespace vismap {

std::string PoseDigest(const Pose& pose) {
  Digest digest;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) digest.Add(pose(row, column) + 0.0);  // -0 is 0
  }
  return digest.Hex().substr(0, 16);
}

}  // namespace vismap
