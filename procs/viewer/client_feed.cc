#include "viewer/client_feed.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/json_text.h"

namespace vismap {
namespace {

constexpr double kMapPeriod = 1;        // of the text about the map [s]
constexpr double kResyncPeriod = 2;     // [s]
constexpr double kSortPeriod = 1;       // of the blocks around a new centre [s]
constexpr double kCentreMoved = 0.5;    // from where blocks are sorted again [m]
constexpr size_t kMostPathPart = 2000;  // positions in one text
constexpr size_t kMostCameras = 64;
constexpr size_t kMostPageMemory = 1 << 16;  // of the values in a text of a page [bytes]

FrameBytes BytesOfFrame(const std::string& text) {
  return std::make_shared<const std::vector<uint8_t>>(text.begin(), text.end());
}

// Sets a flag of the page; false when the value is of another type.
bool ReadFlag(const nlohmann::json& json, const char* key, bool* flag) {
  if (!json.contains(key)) return true;
  if (!json[key].is_boolean()) return false;
  *flag = json[key].get<bool>();
  return true;
}

Result<std::set<int>> ReadCameras(const nlohmann::json& list) {
  std::set<int> cameras;
  if (!list.is_array() || list.size() > kMostCameras)
    return Fail("pictures: expected at most 64 ids of cameras, found " + DescribeJson(list));
  for (const nlohmann::json& id : list) {
    if (!id.is_number_integer()) return Fail("pictures: expected ids, found " + DescribeJson(id));
    cameras.insert(id.get<int>());
  }
  return cameras;
}

Result<std::optional<Eigen::Vector3d>> ReadCentre(const nlohmann::json& point) {
  if (point.is_null()) return std::nullopt;
  const bool three =
      point.is_array() && point.size() == 3 &&
      std::all_of(point.begin(), point.end(), [](const auto& x) { return x.is_number(); });
  if (!three) return Fail("centre: expected null or three numbers, found " + DescribeJson(point));
  const Eigen::Vector3d centre_W(point[0].get<double>(), point[1].get<double>(),
                                 point[2].get<double>());
  if (!centre_W.allFinite() || centre_W.cwiseAbs().maxCoeff() > 1e6)
    return Fail("centre: expected numbers of at most 1000000 m");
  return centre_W;
}

}  // namespace

ClientFeed::ClientFeed(SurfaceView* surface, const Board* board, std::string hello,
                       FeedLimits limits)
    : surface_(surface), board_(board), hello_(std::move(hello)), limits_(limits) {
  Restart();
}

void ClientFeed::Restart() {
  reset_ = true;
  map_due_ = 0;
  batch_.clear();
  dirty_.clear();
  surface_->OnForget();
  for (const BlockIndex& index : surface_->SortedIndices()) dirty_.insert(index);
}

void ClientFeed::OnChanges(const SurfaceChanges& changes) {
  if (changes.reset) return Restart();
  dirty_.insert(changes.blocks.begin(), changes.blocks.end());
}

void ClientFeed::SetLacking(const std::vector<BlockIndex>& blocks) {
  batch_.clear();
  dirty_.clear();
  dirty_.insert(blocks.begin(), blocks.end());
}

void ClientFeed::AddNotice(std::string level, std::string sentence) {
  if (notices_.size() >= kMostNotices) notices_.pop_front();
  notices_.push_back(NoticeText(std::move(level), std::move(sentence)));
}

void ClientFeed::Allow(double bytes) {
  allowance_ = std::min(allowance_ + bytes, limits_.most_allowance);
}

Result<void> ClientFeed::OnText(std::string_view text, double now) {
  if (now - second_ >= 1) {
    second_ = now;
    messages_ = 0;
  }
  if (++messages_ > kMostMessagesPerSecond)
    return Fail("more than " + std::to_string(kMostMessagesPerSecond) + " messages per second");
  const Result<nlohmann::json> json = ParseJson(text, kMostPageMemory);
  if (!json) return Fail("a message is not JSON: " + json.error().message);
  if (!json->is_object() || !json->contains("kind") || !(*json)["kind"].is_string())
    return Fail("a message must be an object with a kind, found " + DescribeJson(*json));
  const auto kind = (*json)["kind"].get<std::string>();
  if (kind == "ack") return ReadAck(*json);
  if (kind == "want") return ReadWant(*json);
  if (kind == "moment" && limits_.has_moments) return ReadMoment(*json);
  if (kind != "resync")
    return Fail("the kind of a message must be want, ack or resync" +
                std::string(limits_.has_moments ? ", or moment" : "") + ", found " +
                DescribeJson((*json)["kind"]));
  if (now < next_resync_) return {};
  next_resync_ = now + kResyncPeriod;
  Restart();
  return {};
}

Result<void> ClientFeed::ReadAck(const nlohmann::json& json) {
  if (!json.contains("bytes") || !json["bytes"].is_number_integer())
    return Fail("ack: bytes must be a whole number");
  const int64_t before = acknowledged_;
  acknowledged_ = std::clamp<int64_t>(json["bytes"].get<int64_t>(), acknowledged_, sent_bytes_);
  // A fast page has much to acknowledge.
  if (acknowledged_ - before >= kFreeAcknowledgement) --messages_;
  return {};
}

Result<void> ClientFeed::ReadWant(const nlohmann::json& json) {
  if (!ReadFlag(json, "mesh", &wants_mesh_) || !ReadFlag(json, "processes", &wants_processes_) ||
      !ReadFlag(json, "batches", &wants_batches_))
    return Fail("want: mesh, processes and batches must be true or false");
  if (json.contains("pictures")) {
    Result<std::set<int>> cameras = ReadCameras(json["pictures"]);
    if (!cameras) return tl::unexpected(cameras.error());
    pictures_wanted_ = std::move(*cameras);
    std::erase_if(sent_pictures_, [&](const auto& e) { return !WantsPicture(e.first); });
  }
  if (!json.contains("centre")) return {};
  const auto centre_W = ReadCentre(json["centre"]);
  if (!centre_W) return tl::unexpected(centre_W.error());
  centre_W_ = *centre_W;
  return {};
}

Result<void> ClientFeed::ReadMoment(const nlohmann::json& json) {
  const bool newest = json.contains("frames") && json["frames"].is_null();
  if (!newest && (!json.contains("frames") || !json["frames"].is_number_integer()))
    return Fail("moment: frames must be a whole number, or null for the newest moment");
  moment_wanted_ = newest ? kNewestMoment : json["frames"].get<int64_t>();
  return {};
}

std::optional<OutFrame> ClientFeed::Next(double now) {
  if (!wants_mesh_ || waiting() == 0) text_debt_ = 0;
  if (auto text = NextText(now)) return text;
  if (allowance_ <= 0 || unacknowledged() >= limits_.most_unacknowledged) return std::nullopt;
  if (auto path = NextPath()) return path;
  if (auto picture = NextPicture()) return picture;
  if (!wants_mesh_) return std::nullopt;
  FollowCentre(now);
  return NextBlocks();
}

// Sorting all that waits is expensive, and a page may move its centre often.
void ClientFeed::FollowCentre(double now) {
  const bool moved = centre_W_.has_value() != sorted_centre_W_.has_value() ||
                     (centre_W_ && (*centre_W_ - *sorted_centre_W_).norm() > kCentreMoved);
  if (batch_.empty() || !moved || now < next_sort_) return;
  next_sort_ = now + kSortPeriod;
  dirty_.insert(batch_.begin(), batch_.end());
  batch_.clear();
}

std::optional<OutFrame> ClientFeed::NextText(double now) {
  if (!hello_.empty()) return OutFrame{BytesOfFrame(std::exchange(hello_, "")), true};
  if (!notices_.empty()) {
    const std::string notice = std::move(notices_.front());
    notices_.pop_front();
    return OutFrame{BytesOfFrame(notice), true};
  }
  if (now >= map_due_) {
    map_due_ = now + kMapPeriod;
    return OutFrame{BytesOfFrame(MapText(board_->map, waiting(), std::exchange(reset_, false))),
                    true};
  }
  return NextTopic();
}

std::optional<OutFrame> ClientFeed::NextTopic() {
  for (size_t i = 0; i < Board::kTopics; ++i) {
    const auto topic = static_cast<Board::Topic>(i);
    const Board::Post& post = board_->Get(topic);
    if (topic == Board::Topic::kProcesses && !wants_processes_) continue;
    if (post.number == 0 || post.number == sent_topics_[i]) continue;
    const auto size = static_cast<double>(post.bytes->size());
    if (post.bytes->size() > kSmallText) {
      if (allowance_ <= 0 || text_debt_ > 0) continue;
      text_debt_ = size;
    }
    allowance_ -= size;
    sent_topics_[i] = post.number;
    return OutFrame{post.bytes, true};
  }
  return std::nullopt;
}

std::optional<OutFrame> ClientFeed::NextPath() {
  if (paths_number_ != board_->paths_number()) {
    paths_number_ = board_->paths_number();
    sent_positions_.clear();
  }
  for (const auto& [camera_id, path] : board_->paths()) {
    size_t& sent = sent_positions_[camera_id];
    if (sent >= path.size()) continue;
    const size_t count = std::min(kMostPathPart, path.size() - sent);
    const std::string text = TrajectoryText(camera_id, sent, std::span(path).subspan(sent, count));
    sent += count;
    allowance_ -= static_cast<double>(text.size());
    return OutFrame{BytesOfFrame(text), true};
  }
  return std::nullopt;
}

std::optional<OutFrame> ClientFeed::NextPicture() {
  for (const auto& [camera_id, post] : board_->pictures()) {
    if (!WantsPicture(camera_id)) continue;
    int64_t& sent = sent_pictures_[camera_id];
    if (sent == post.number) continue;
    sent = post.number;
    return Count(post.bytes);
  }
  return std::nullopt;
}

std::optional<OutFrame> ClientFeed::NextBlocks() {
  FrameBytes first = NextBlock();
  if (first == nullptr) return std::nullopt;
  if (!wants_batches_) return Count(std::move(first));
  const auto most = static_cast<size_t>(std::min<double>(allowance_, kBatchBytes));
  size_t bytes = first->size();
  std::vector<FrameBytes> blocks{std::move(first)};
  while (bytes < most) {
    FrameBytes next = NextBlock();
    if (next == nullptr) break;
    bytes += next->size();
    blocks.push_back(std::move(next));
  }
  if (blocks.size() == 1) return Count(std::move(blocks.front()));
  return Count(std::make_shared<const std::vector<uint8_t>>(EncodeBlockBatch(blocks)));
}

FrameBytes ClientFeed::NextBlock() {
  if (batch_.empty()) FillBatch();
  if (batch_.empty()) return nullptr;
  const BlockIndex index = batch_.back();
  batch_.pop_back();
  dirty_.erase(index);  // it may have changed again since the batch was filled
  if (FrameBytes bytes = surface_->BytesOf(index)) return bytes;
  return std::make_shared<const std::vector<uint8_t>>(
      EncodeDeletedBlock(index, surface_->block_edge_m(), surface_->revision()));
}

// The nearest block comes last in the batch. Blocks that change later wait for the next batch, so
// that none waits for ever.
void ClientFeed::FillBatch() {
  batch_.assign(dirty_.begin(), dirty_.end());
  dirty_.clear();
  sorted_centre_W_ = centre_W_;
  const double edge = std::max(surface_->block_edge_m(), 1e-3);
  const Eigen::Vector3d centre =
      centre_W_ ? Eigen::Vector3d(*centre_W_ / edge) : Eigen::Vector3d::Zero();
  const auto distance = [&](const BlockIndex& b) {
    return (Eigen::Vector3d(b.x + 0.5, b.y + 0.5, b.z + 0.5) - centre).squaredNorm();
  };
  std::sort(batch_.begin(), batch_.end(), [&](const BlockIndex& a, const BlockIndex& b) {
    const double da = distance(a), db = distance(b);
    return da != db ? da > db : b < a;
  });
}

OutFrame ClientFeed::Count(FrameBytes bytes) {
  sent_bytes_ += static_cast<int64_t>(bytes->size());
  allowance_ -= static_cast<double>(bytes->size());
  text_debt_ -= static_cast<double>(bytes->size());
  return {std::move(bytes), false};
}

size_t ClientFeed::bytes() const {
  size_t total = sizeof *this + batch_.capacity() * sizeof(BlockIndex) +
                 dirty_.bucket_count() * (sizeof(BlockIndex) + 8);
  for (const std::string& notice : notices_) total += notice.size();
  return total;
}

}  // namespace vismap
