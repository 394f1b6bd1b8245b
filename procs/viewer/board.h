#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "viewer/page_messages.h"

namespace vismap {

/// What all pages may get besides the surface, in its newest state: encoded once, and shared by the
/// pages. Every change has a number, by which a page's feed sees what it has not sent yet.
class Board {
 public:
  /// Subjects of which only the newest text counts.
  enum class Topic { kObjects, kProcesses, kCameras, kNavigation, kTimeline };
  static constexpr size_t kTopics = 5;
  struct Post {
    FrameBytes bytes;    ///< nullptr = nothing yet
    int64_t number = 0;  ///< of the change; 0 = nothing yet
  };
  /// Positions of all cameras together; further ones are left out.
  static constexpr size_t kMostPositions = 1000000;
  static constexpr size_t kMostPictures = 16;  ///< cameras with a picture

  /// An equal text is no change.
  void Set(Topic topic, const std::string& text);
  /// Takes the text away, as after a reset of the map.
  void Remove(Topic topic) { posts_[static_cast<size_t>(topic)] = {}; }
  const Post& Get(Topic topic) const { return posts_[static_cast<size_t>(topic)]; }

  /// Further pictures of new cameras are left out beyond kMostPictures. Returns its number; 0 =
  /// left out.
  int64_t SetPicture(int camera_id, std::vector<uint8_t> bytes);
  const std::map<int, Post>& pictures() const { return pictures_; }
  void RemovePictures() { pictures_.clear(); }

  MapSummary map;  ///< written by the viewer once a second

  using Path = std::vector<std::array<float, 3>>;  ///< positions in W [m]
  void AddPosition(int camera_id, const std::array<float, 3>& p_W);
  /// The paths belong to another map from now on.
  void RestartPaths();
  const std::map<int, Path>& paths() const { return paths_; }
  int64_t paths_number() const { return paths_number_; }  ///< changes with RestartPaths

 private:
  std::array<Post, kTopics> posts_;
  std::map<int, Post> pictures_;  // by camera
  std::map<int, Path> paths_;
  size_t positions_ = 0;
  int64_t next_ = 1, paths_number_ = 0;
};

}  // namespace vismap
