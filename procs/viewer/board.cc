#include "viewer/board.h"

#include <algorithm>
#include <utility>

namespace vismap {

void Board::Set(Topic topic, const std::string& text) {
  Post& post = posts_[static_cast<size_t>(topic)];
  if (post.bytes && std::equal(post.bytes->begin(), post.bytes->end(), text.begin(), text.end(),
                               [](uint8_t a, char b) { return a == static_cast<uint8_t>(b); }))
    return;
  post = {std::make_shared<const std::vector<uint8_t>>(text.begin(), text.end()), next_++};
}

int64_t Board::SetPicture(int camera_id, std::vector<uint8_t> bytes) {
  if (!pictures_.contains(camera_id) && pictures_.size() >= kMostPictures) return 0;
  pictures_[camera_id] = {std::make_shared<const std::vector<uint8_t>>(std::move(bytes)), next_};
  return next_++;
}

void Board::AddPosition(int camera_id, const std::array<float, 3>& p_W) {
  if (positions_ >= kMostPositions) return;
  ++positions_;
  paths_[camera_id].push_back(p_W);
}

void Board::RestartPaths() {
  paths_.clear();
  positions_ = 0;
  ++paths_number_;
}

}  // namespace vismap
