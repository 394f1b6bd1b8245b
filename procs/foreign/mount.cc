#include "foreign/mount.h"

#include <array>
#include <cmath>
#include <sstream>

namespace vismap {

Result<Mount> ParseMount(const std::string& text) {
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  Mount mount;
  std::array<double, 7> numbers{};
  words >> mount.parent >> mount.child;
  for (double& number : numbers) words >> number;
  std::string rest;
  if (!words || words >> rest) {
    return Fail("expected \"parent child x y z qw qx qy qz\", found \"" + text + "\"");
  }
  const Eigen::Quaterniond rotation(numbers[3], numbers[4], numbers[5], numbers[6]);
  if (!(std::abs(rotation.norm() - 1) < 0.01))
    return Fail("the quaternion (w, x, y, z) does not have unit length in \"" + text + "\"");
  mount.T_parent_child.linear() = rotation.normalized().toRotationMatrix();
  mount.T_parent_child.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  return mount;
}

}  // namespace vismap
