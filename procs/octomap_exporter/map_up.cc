#include "octomap_exporter/map_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "wire/object_list.h"

namespace vismap {

Result<void> MapUp::Hear(const object_list_t& message) {
  const Result<ObjectList> list = Decode(message);
  if (!list) return tl::unexpected(list.error());
  if (list->map_id != map_id_) up_W_.reset();
  map_id_ = list->map_id;
  const auto standing = std::find_if(
      list->objects.begin(), list->objects.end(),
      [](const ObjectSummary& object) { return !object.removed() && object.box.size.norm() > 0; });
  if (standing != list->objects.end()) up_W_ = standing->box.R_W_B * Eigen::Vector3d::UnitZ();
  return {};
}

std::optional<std::string> MapUp::GridProblem(const std::string& map_id) const {
  if (!up_W_ || map_id != map_id_) return std::nullopt;
  const double tilt =
      std::acos(std::clamp(up_W_->z(), -1.0, 1.0)) * 180 / std::numbers::pi;  // [degrees]
  if (tilt <= kMostTilt) return std::nullopt;
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(),
                "a grid needs z of the map to point upward, but the map server has found that "
                "(%.2f, %.2f, %.2f) does, %.0f degrees from z; publish poses in a world whose z is "
                "up, or, if z is up, set objects { up_W: [0, 0, 1] } for the map server",
                up_W_->x(), up_W_->y(), up_W_->z(), tilt);
  return text.data();
}

}  // namespace vismap
