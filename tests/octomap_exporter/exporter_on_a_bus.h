#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "octomap_exporter/exporter.h"
#include "runtime/clock.h"
#include "support/occupancy_snapshot.h"

namespace vismap::testing_support {

/// An exporter on a bus of its own, a map that it follows, and what it answers.
class ExporterOnABus : public ::testing::Test {
 protected:
  static constexpr double kVoxel = 0.02;

  ExporterOnABus() {
    config_.grid.voxel_size_m = kVoxel;
    config_.octomap_exporter.period_s = 0.05;
    bus_->Subscribe<navigation_status_t>(
        kNavigationChannel, [this](const navigation_status_t& message) { navigation_ = message; });
    bus_->Subscribe<map_reply_t>(kMapReplyChannel,
                                 [this](const map_reply_t& reply) { replies_.push_back(reply); });
  }

  void Start() { exporter_ = std::make_unique<Exporter>(config_, bus_.get(), &status_); }

  template <typename Condition>
  bool SpinUntil(const Condition& condition, double seconds = 10) {
    const double end = MonotonicSeconds() + seconds;
    while (!condition() && MonotonicSeconds() < end) bus_->Spin(0.01);
    return condition();
  }
  void SpinFor(double seconds) {
    SpinUntil([] { return false; }, seconds);
  }

  /// Free space above a floor.
  void FillRoom() {
    for (int i = 0; i < 12 * 12 * 8; ++i) {
      map_.Set({i % 12 - 4, i / 12 % 12 - 5, i / 144},
               BlockOccupancy(i < 144 ? CellState::kOccupied : CellState::kFree));
    }
  }
  /// Sends the whole map as its next revision.
  void SendMap() {
    ++revision_;
    bus_->Publish(kMapDeltaChannel,
                  Encode(MapUpdate{1000 * revision_, "m", revision_, -1, 0, 1, SnapshotOf(map_)}));
  }
  /// Changes one block, and sends the change.
  void Change(BlockIndex index, CellState state) {
    map_.Set(index, BlockOccupancy(state));
    OccupancyDelta delta{kVoxel, false, {{index, map_.At(index)}}};
    ++revision_;
    bus_->Publish(kMapDeltaChannel, Encode(MapUpdate{1000 * revision_, "m", revision_,
                                                     revision_ - 1, 0, 1, std::move(delta)}));
  }

  static map_request_t Request(const std::string& verb, const std::string& argument = "") {
    map_request_t request{};
    request.verb = verb;
    request.argument = argument;
    request.unknown = map_request_t::UNKNOWN_DEFAULT;
    return request;
  }
  map_reply_t Ask(map_request_t request) {
    request.request_id = ++next_id_;
    bus_->Publish(kMapRequestChannel, request);
    EXPECT_TRUE(SpinUntil(
        [&] { return !replies_.empty() && replies_.back().request_id == request.request_id; }));
    return replies_.empty() ? map_reply_t{} : replies_.back();
  }
  map_reply_t Ask(const std::string& verb, const std::string& argument = "") {
    return Ask(Request(verb, argument));
  }

  std::unique_ptr<Bus> bus_ = std::move(*Bus::Open({"memq://", "test"}));
  Status status_{bus_.get(), "octomap-exporter"};
  VismapConfig config_;
  OccupancyMap map_{kVoxel};
  int64_t revision_ = 0;
  navigation_status_t navigation_{};
  std::vector<map_reply_t> replies_;
  std::unique_ptr<Exporter> exporter_;

 private:
  int64_t next_id_ = 0;
};

}  // namespace vismap::testing_support
