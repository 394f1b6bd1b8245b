#include "config/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <sstream>

#include "config/bindings.h"
#include "options.pb.h"
#include "support/published_options.h"

namespace vismap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing_support::PublishedOptions;

VismapConfig Parsed(const std::string& text) {
  Result<VismapConfig> config = ParseConfig(text, "test.txtpb");
  EXPECT_TRUE(config) << config.error().message;
  return config.value_or(VismapConfig{});
}

std::string ErrorOf(const std::string& text) {
  const Result<VismapConfig> config = ParseValidConfig(text, "test.txtpb");
  EXPECT_FALSE(config) << text;
  return config ? "" : config.error().message;
}

/// Counts the keys that the bindings name.
struct KeyCounter {
  std::vector<std::string> keys;
  std::string prefix;
  template <typename T>
  void Value(const char* key, T&) {
    keys.push_back(prefix + key);
  }
  void Classes(const char* key, std::vector<ClassId>&) { keys.push_back(prefix + key); }
  void Direction(const char* key, std::optional<Eigen::Vector3d>&) { keys.push_back(prefix + key); }
  void Sensor(const char* key, DepthNoiseModel&) { keys.push_back(prefix + key); }
  void Section(const char* key, const std::function<void(KeyCounter&)>& body) {
    const std::string outer = prefix;
    prefix += std::string(key) + ".";
    body(*this);
    prefix = outer;
  }
};

TEST(Bindings, EveryKeyOfTheProtoIsBoundOnce) {
  KeyCounter counter;
  VismapConfig config;
  config::BindConfig(counter, config);
  std::vector<std::string> expected;
  const auto* sections = config::Config::descriptor();
  for (int i = 0; i < sections->field_count(); ++i) {
    const auto* section = sections->field(i);
    for (int j = 0; j < section->message_type()->field_count(); ++j) {
      expected.push_back(section->name() + "." + section->message_type()->field(j)->name());
    }
  }
  EXPECT_THAT(counter.keys, testing::UnorderedElementsAreArray(expected));
}

struct AnyValue {
  template <typename T>
  operator T() const;  // NOLINT: never called, only looked at by the compiler
};

/// Number of members of a plain struct.
template <typename Struct, typename... Values>
constexpr size_t MemberCount() {
  if constexpr (requires { Struct{Values{}..., AnyValue{}}; }) {
    return MemberCount<Struct, Values..., AnyValue>();
  } else {
    return sizeof...(Values);
  }
}

/// Number of keys that a binding function names for an option struct.
template <typename Options>
size_t KeyCount(void (*bind)(KeyCounter&, Options&)) {
  KeyCounter counter;
  Options options;
  bind(counter, options);
  return counter.keys.size();
}

TEST(Bindings, EveryMemberOfTheOptionStructsHasAKey) {
  using namespace config;  // NOLINT
  constexpr size_t kNoise = MemberCount<DepthNoiseModel>();
  EXPECT_EQ(KeyCount(BindSurface<KeyCounter>), MemberCount<SurfaceOptions>() + kNoise);
  EXPECT_EQ(KeyCount(BindSegmentation<KeyCounter>), MemberCount<SegmentationOptions>());
  EXPECT_EQ(KeyCount(BindRefine<KeyCounter>), MemberCount<RefineOptions>());
  constexpr size_t kRange = 2;  // taken from the integration
  EXPECT_EQ(KeyCount(BindAssociation<KeyCounter>) + kRange, MemberCount<AssociationOptions>());
  constexpr size_t kSensor = 1;  // taken from the surface
  EXPECT_EQ(KeyCount(BindIntegration<KeyCounter>) + kSensor, MemberCount<IntegrationOptions>());
  EXPECT_EQ(KeyCount(BindMeshing<KeyCounter>), MemberCount<MeshingOptions>());
  // One member has keys of its own; up_is_guess follows from whether there is an up_W.
  constexpr size_t kNoKey = 2;
  EXPECT_EQ(KeyCount(BindObjects<KeyCounter>) + kNoKey,
            MemberCount<ObjectOptions>() + MemberCount<StructureOptions>());
  EXPECT_EQ(KeyCount(BindFreeSpace<KeyCounter>), MemberCount<OccupancyOptions>());
  EXPECT_EQ(KeyCount(BindDepthSegmenter<KeyCounter>), MemberCount<DepthSegmenterConfig>());
  EXPECT_EQ(KeyCount(BindMapServer<KeyCounter>), MemberCount<MapServerConfig>());
  EXPECT_EQ(KeyCount(BindOctomapExporter<KeyCounter>), MemberCount<OctomapExporterConfig>());
  EXPECT_EQ(KeyCount(BindSensorReplay<KeyCounter>), MemberCount<SensorReplayConfig>());
  constexpr size_t kNetwork = 1;  // one member, whose own members are keys
  EXPECT_EQ(KeyCount(BindDetector<KeyCounter>) + kNetwork,
            MemberCount<DetectorConfig>() + MemberCount<DnnDetectorOptions>());
  EXPECT_EQ(KeyCount(BindHub<KeyCounter>), MemberCount<HubConfig>());
  EXPECT_EQ(KeyCount(BindBridge<KeyCounter>), MemberCount<BridgeConfig>());
}

/// Gives every value another one, so that a binding to the wrong member shows.
struct Changer {
  int* counter;
  void Value(const char*, double& member) { member += 0.001 * ++*counter; }
  void Value(const char*, int& member) { member += ++*counter; }
  void Value(const char*, bool& member) { member = !member; }
  void Value(const char*, std::string& member) { member += "\"\n" + std::to_string(++*counter); }
  void Value(const char*, std::vector<std::string>& member) {
    member = {"A.*", "\"" + std::to_string(++*counter)};
  }
  template <typename Enum>
  void Value(const char*, Enum& member) {
    member = static_cast<Enum>(1 - static_cast<int>(member));
  }
  void Classes(const char*, std::vector<ClassId>& member) {
    member = {ClassId{1}, ClassId{static_cast<uint16_t>(300 + ++*counter)}};
  }
  void Direction(const char*, std::optional<Eigen::Vector3d>& member) {
    member = Eigen::Vector3d(1.0 / 3, -2.0 / 3, 2.0 / 3);
  }
  void Sensor(const char*, DepthNoiseModel&) {}
  void Section(const char*, const std::function<void(Changer&)>& body) { body(*this); }
};

TEST(Config, PrintedTextParsesBackToTheSame) {
  VismapConfig config;
  EXPECT_EQ(PrintConfig(Parsed(PrintConfig(config))), PrintConfig(config));
  int counter = 0;
  Changer changer{&counter};
  config::BindConfig(changer, config);
  EXPECT_GT(counter, 60);
  const VismapConfig again = Parsed(PrintConfig(config));
  EXPECT_EQ(PrintConfig(again), PrintConfig(config));
  EXPECT_EQ(again.grid.voxel_size_m, config.grid.voxel_size_m);
  EXPECT_EQ(again.segmentation.surface.noise, config.segmentation.surface.noise);
  EXPECT_EQ(again.segmentation.refine.split_min_rest_px,
            config.segmentation.refine.split_min_rest_px);
  EXPECT_EQ(again.up_W, config.up_W);
  EXPECT_EQ(again.map_server.save_on_exit, config.map_server.save_on_exit);
  EXPECT_NE(PrintConfig(config), PrintConfig(VismapConfig{}));
}

TEST(Config, DescriptionHasEveryKeyWithItsMeaningAndParsesBackToTheSame) {
  VismapConfig config;
  config.up_W = Eigen::Vector3d(0, -0.6, 0.8);
  config.map_server.save_on_exit = "a \"quoted\" # name";
  const std::string text = DescribeConfig(config);
  EXPECT_EQ(PrintConfig(Parsed(text)), PrintConfig(config));
  KeyCounter counter;
  config::BindConfig(counter, config);
  for (const std::string& key : counter.keys) {
    EXPECT_THAT(text, HasSubstr(key.substr(key.find('.') + 1) + ":")) << key;
  }
  EXPECT_THAT(text, HasSubstr("  # Edge of a voxel.\n  voxel_size_m: 0.01\n"));
  EXPECT_THAT(text, HasSubstr("  # KINECT, REALSENSE or CLEAN.\n  # sensor:\n"));
  std::string line;
  std::istringstream lines(text);
  for (bool comment = false; std::getline(lines, line); comment = line.find('#') == 2) {
    const bool key = line.starts_with("  ") && line.find('#') == std::string::npos;
    EXPECT_TRUE(!key || comment || line.starts_with("  up_W")) << "no comment before " << line;
  }
}

TEST(Config, AwkwardNumbersSurvivePrinting) {
  VismapConfig config;
  for (const double number :
       {0.1, 1.0 / 3, 1e-300, 123456789.123456789, std::numeric_limits<double>::infinity()}) {
    config.integration.max_weight = number;
    EXPECT_EQ(Parsed(PrintConfig(config)).integration.max_weight, number);
  }
}

TEST(ParseConfig, EmptyTextIsTheDefault) {
  EXPECT_EQ(PrintConfig(Parsed("")), PrintConfig(VismapConfig{}));
  EXPECT_EQ(PrintConfig(Parsed("# nothing\ngrid {}\n")), PrintConfig(VismapConfig{}));
  EXPECT_THAT(Validate(VismapConfig{}), IsEmpty());
}

TEST(ParseConfig, SetsWhatIsSaidAndNothingElse) {
  const VismapConfig config = Parsed("grid { voxel_size_m: 0.02 } refine { split: false }");
  VismapConfig expected;
  expected.grid.voxel_size_m = 0.02;
  expected.segmentation.refine.split = false;
  EXPECT_EQ(PrintConfig(config), PrintConfig(expected));
}

TEST(ParseConfig, SensorIsAStartThatFieldsChange) {
  DepthNoiseModel expected = RealSenseNoise();
  expected.axial_offset_m = 0.5;
  const VismapConfig config = Parsed("surface { noise_axial_offset_m: 0.5 sensor: REALSENSE }");
  EXPECT_EQ(config.segmentation.surface.noise, expected);
  EXPECT_EQ(Parsed("surface { sensor: CLEAN }").segmentation.surface.noise, CleanNoise());
  EXPECT_EQ(Parsed("surface { sensor: REALSENSE }").integration.noise, RealSenseNoise());
}

TEST(ParseConfig, NamesOfChoicesMeanWhatTheySay) {
  const SurfaceOptions surface =
      Parsed("surface { method: WINDOW_COVARIANCE }").segmentation.surface;
  EXPECT_EQ(surface.method, NormalMethod::kWindowCovariance);
  EXPECT_EQ(Parsed("surface { method: INVERSE_DEPTH_FIT }").segmentation.surface.method,
            NormalMethod::kInverseDepthFit);
  EXPECT_EQ(Parsed("segmentation { method: PUBLISHED }").segmentation.segmentation.method,
            SegmentationMethod::kPublished);
  EXPECT_EQ(Parsed("segmentation { method: NOISE_SCALED }").segmentation.segmentation.method,
            SegmentationMethod::kNoiseScaled);
  EXPECT_EQ(Parsed("depth_segmenter { detections: REQUIRED }").depth_segmenter.detections,
            WaitForDetections::kRequired);
  EXPECT_EQ(Parsed("depth_segmenter { detections: AUTO }").depth_segmenter.detections,
            WaitForDetections::kAuto);
  EXPECT_EQ(Parsed("depth_segmenter { detections: NONE }").depth_segmenter.detections,
            WaitForDetections::kNone);
  EXPECT_EQ(Parsed("octomap_exporter { unknown: OCCUPIED }").octomap_exporter.unknown,
            UnknownPolicy::kOccupied);
  EXPECT_EQ(Parsed("octomap_exporter { unknown: ABSENT }").octomap_exporter.unknown,
            UnknownPolicy::kAbsent);
}

TEST(ParseConfig, NamesOfDetectorsMeanWhatTheySay) {
  const auto detector = [](const std::string& text) {
    return Parsed("detector { " + text + " }").detector;
  };
  EXPECT_EQ(detector("backend: AUTO").backend, DetectorBackend::kAuto);
  EXPECT_EQ(detector("backend: RECORDED").backend, DetectorBackend::kRecorded);
  EXPECT_EQ(detector("backend: DNN").backend, DetectorBackend::kDnn);
  EXPECT_EQ(detector("kind: BY_NAME").dnn.kind, DnnModelKind::kAuto);
  EXPECT_EQ(detector("kind: YOLO_SEG").dnn.kind, DnnModelKind::kYoloSeg);
  EXPECT_EQ(detector("kind: MASK_RCNN").dnn.kind, DnnModelKind::kMaskRcnn);
  EXPECT_THAT(ErrorOf("detector { max_detections: 0 }"), HasSubstr("[1, 1000]"));
}

TEST(ParseConfig, ListsOfChannels) {
  const HubConfig hub = Parsed("hub { lossless: [\"A\", \"B.*\"] latest: \"C\" }").hub;
  EXPECT_THAT(hub.lossless, testing::ElementsAre("A", "B.*"));
  EXPECT_THAT(hub.latest, testing::ElementsAre("C"));
  EXPECT_THAT(hub.drop_newest, IsEmpty());
}

TEST(ParseConfig, AssociationTakesTheRangeOfTheIntegration) {
  const VismapConfig config = Parsed("integration { min_range_m: 0.4 max_range_m: 3.5 }");
  EXPECT_EQ(config.association.min_range_m, 0.4);
  EXPECT_EQ(config.association.max_range_m, 3.5);
  EXPECT_THAT(Validate(config), IsEmpty());
}

TEST(ParseConfig, ErrorsNameFileLineAndColumn) {
  EXPECT_THAT(ErrorOf("grid {\n  voxel_sise_m: 0.02\n}\n"),
              testing::AllOf(HasSubstr("test.txtpb:2:"), HasSubstr("voxel_sise_m")));
  EXPECT_THAT(ErrorOf("grid {\n  voxel_size_m: \"small\"\n}\n"), HasSubstr("test.txtpb:2:"));
  EXPECT_THAT(ErrorOf("refine { split: 3.5 }"), HasSubstr("test.txtpb:1:"));
  EXPECT_THAT(ErrorOf("surface { method: FAST }"), HasSubstr("FAST"));
  EXPECT_THAT(ErrorOf("grid {\n"), HasSubstr("test.txtpb:"));
  EXPECT_THAT(ErrorOf("grid { voxel_size_m: 0.01 voxel_size_m: 0.02 }"), HasSubstr("voxel_size_m"));
  EXPECT_THAT(ErrorOf("association { min_overlap_points: 1e30 }"), HasSubstr("test.txtpb:1:"));
  EXPECT_THAT(ErrorOf("objects { up_W: [0, 1] }"), HasSubstr("objects.up_W: expected three"));
}

TEST(Validate, BridgesTakeNamesOfChannels) {
  EXPECT_THAT(ErrorOf("bridge { send: \"RGBD_.*\" }"), HasSubstr("'RGBD_.*' is not the name"));
  EXPECT_THAT(Validate(Parsed("bridge { send: [\"RGBD_FRAME\", \"robot1-POSE\"] }")), IsEmpty());
}

TEST(Validate, ReturnsAllProblemsAtOnce) {
  const VismapConfig config = Parsed(
      "grid { voxel_size_m: 0 truncation_voxels: 2 } integration { max_range_m: -1 } "
      "free_space { min_observations: 0 } objects { up_W: [0, 0, 2] } "
      "octree { free_fraction: 0 } map_server { save_period_s: 5 }");
  EXPECT_THAT(Validate(config), SizeIs(testing::Ge(7u)));
  EXPECT_THAT(ErrorOf("grid { voxel_size_m: 0 truncation_voxels: 2 }"),
              testing::AllOf(HasSubstr("voxel_size_m"), HasSubstr("; grid.truncation_voxels")));
}

/// Makes one double NaN.
struct Poisoner {
  int target = 0;
  int at = 0;
  void Value(const char*, double& member) {
    if (at++ == target) member = std::nan("");
  }
  template <typename T>
  void Value(const char*, T&) {}
  void Classes(const char*, std::vector<ClassId>&) {}
  void Direction(const char*, std::optional<Eigen::Vector3d>&) {}
  void Sensor(const char*, DepthNoiseModel&) {}
  void Section(const char*, const std::function<void(Poisoner&)>& body) { body(*this); }
};

TEST(Validate, NotANumberIsAProblemWhereverItStands) {
  for (int target = 0;; ++target) {
    VismapConfig config;
    Poisoner poisoner{target};
    config::BindConfig(poisoner, config);
    if (poisoner.at <= target) break;
    EXPECT_FALSE(Validate(config).empty()) << "double number " << target;
  }
}

TEST(Validate, OctreeResolutionMustFitTheVoxels) {
  EXPECT_THAT(ErrorOf("grid { voxel_size_m: 0.02 } octree { resolution_m: 0.05 }"),
              HasSubstr("nearest is 0.06 m"));
}

TEST(LoadConfig, MissingFileIsNamed) {
  const Result<VismapConfig> config = LoadConfig("/nowhere/none.txtpb");
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error().message, HasSubstr("/nowhere/none.txtpb"));
}

VismapConfig Preset(const std::string& name) {
  const Result<VismapConfig> config =
      LoadConfig(std::string(VISMAP_SOURCE_DIR) + "/config/" + name);
  EXPECT_TRUE(config) << config.error().message;
  return config.value_or(VismapConfig{});
}

TEST(Presets, EveryFileLoadsAndIsValid) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(VISMAP_SOURCE_DIR) + "/config")) {
    if (entry.path().extension() != ".txtpb") continue;
    Preset(entry.path().filename());
    ++count;
  }
  EXPECT_GE(count, 4);
}

TEST(Presets, DefaultIsTheDefault) {
  EXPECT_EQ(PrintConfig(Preset("default.txtpb")), PrintConfig(VismapConfig{}));
}

TEST(Presets, PublishedHasThePublishedSegmentation) {
  const VismapConfig preset = Preset("published.txtpb");
  VismapConfig expected = preset;
  expected.segmentation = PublishedOptions();
  expected.segmentation.refine.min_score = 0.7;  // of the detector, in the published system
  EXPECT_EQ(PrintConfig(preset), PrintConfig(expected));
}

TEST(Config, ClassesToLeaveOutAreNamesOrIds) {
  const VismapConfig config = Parsed("refine { leave_out_classes: [\"person\", \"18\", \"300\"] }");
  EXPECT_THAT(config.segmentation.refine.leave_out_classes,
              testing::ElementsAre(ClassId{1}, ClassId{18}, ClassId{300}));
  EXPECT_TRUE(VismapConfig().segmentation.refine.leave_out_classes.empty());
}

TEST(Config, AnUnknownClassToLeaveOutIsAnError) {
  for (const std::string name : {"persons", "unknown", "0", "70000", ""}) {
    const auto config = ParseConfig("refine { leave_out_classes: \"" + name + "\" }", "x");
    ASSERT_FALSE(config) << name;
    EXPECT_THAT(config.error().message,
                testing::HasSubstr("refine.leave_out_classes: '" + name + "' is neither"));
  }
}

}  // namespace
}  // namespace vismap
