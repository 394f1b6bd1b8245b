// Floor, walls and table tops are told from things, whichever way is up.
#include <gmock/gmock.h>

#include "quality/mapped_sequence.h"
#include "simulation/room.h"

namespace vismap {
namespace {

using testing_support::Mapped;

constexpr char kOneTour[] = "synthetic:room?frames=40&width=320";

/// A sequence in a world that is turned about its y axis.
class TurnedDataset : public Dataset {
 public:
  TurnedDataset(const std::string& name, double degrees)
      : level_(std::move(*OpenSequence(name, "", {}))),
        T_V_W_(Eigen::AngleAxisd(degrees * M_PI / 180, Eigen::Vector3d::UnitY())) {}

  std::string name() const override { return level_->name(); }
  std::string format() const override { return level_->format(); }
  size_t size() const override { return level_->size(); }
  FrameHeader Header(size_t i) const override {
    FrameHeader header = level_->Header(i);
    header.T_W_C = T_V_W_ * header.T_W_C;
    return header;
  }
  Result<SensorFrame> Read(size_t i) const override {
    Result<SensorFrame> frame = level_->Read(i);
    if (frame) frame->header = Header(i);
    return frame;
  }
  const std::vector<SkippedFrame>& skipped() const override { return level_->skipped(); }
  std::optional<std::string> default_detections_path() const override { return std::nullopt; }

  Eigen::Vector3d up_W() const { return T_V_W_ * Eigen::Vector3d::UnitZ(); }

 private:
  std::unique_ptr<Dataset> level_;
  Pose T_V_W_;
};

/// The room in a turned world, without any detector.
Mapped MapTurned(const TurnedDataset& dataset, const OutputOptions& options) {
  Mapped mapped;
  StageTimes times;
  const auto proceed = [](size_t) { return true; };
  if (!MapSequence({dataset}, {}, proceed, &mapped.session, &times))
    throw std::runtime_error("the room can be read");
  mapped.products = MakeProducts(mapped.session.map(), mapped.session.metadata(), options);
  return mapped;
}

std::map<StructureKind, int> CountKinds(const std::vector<ObjectSummary>& objects) {
  std::map<StructureKind, int> counts;
  for (const ObjectSummary& object : objects) ++counts[object.structure];
  return counts;
}

class Structure : public ::testing::TestWithParam<double> {};

TEST_P(Structure, IsToldFromThingsWhicheverWayIsUp) {
  const TurnedDataset dataset(kOneTour, GetParam());
  const Mapped mapped = MapTurned(dataset, {});
  auto kinds = CountKinds(mapped.products.objects);
  EXPECT_GE(kinds[StructureKind::kFloor], 1);
  EXPECT_GE(kinds[StructureKind::kWall], 3);
  EXPECT_EQ(kinds[StructureKind::kSloped], 0);
  EXPECT_GE(kinds[StructureKind::kTableTop], 1);
  EXPECT_GE(kinds[StructureKind::kNone], 8) << "things";

  // The table's top, 0.74 m high, and nothing that lies on it.
  const Eigen::Vector3d up = dataset.up_W();
  int on_table = 0, tops = 0;
  for (const ObjectSummary& object : mapped.products.objects) {
    const double height = object.box.center_W.dot(up);
    const double across = (object.box.center_W - height * up).norm();
    if (across > 0.6 || object.removed()) continue;
    if (object.structure == StructureKind::kTableTop) {
      ++tops;
      EXPECT_NEAR(height, 0.75, 0.03);
    } else if (height > 0.77 && height < 1) {
      ++on_table;
      EXPECT_FALSE(object.is_structure());
    }
  }
  EXPECT_EQ(tops, 1);
  EXPECT_GE(on_table, 2);
}

TEST_P(Structure, UpMayBeGiven) {
  const TurnedDataset dataset(kOneTour, GetParam());
  OutputOptions options;
  options.up_W = dataset.up_W();
  auto kinds = CountKinds(MapTurned(dataset, options).products.objects);
  EXPECT_GE(kinds[StructureKind::kFloor], 1);
  EXPECT_GE(kinds[StructureKind::kWall], 3);
  EXPECT_EQ(kinds[StructureKind::kSloped], 0);
}

INSTANTIATE_TEST_SUITE_P(Tilt, Structure, ::testing::Values(0.0, 10.0, 25.0, 50.0));

TEST(NamedStructure, OfANamedTableIsTheTable) {
  const Mapped mapped = testing_support::MapAll(kOneTour);
  int tables = 0;
  for (const ObjectSummary& object : mapped.products.objects)
    tables += object.class_id == ClassId{67} && !object.is_structure() ? 1 : 0;
  EXPECT_EQ(tables, 1);
}

}  // namespace
}  // namespace vismap
