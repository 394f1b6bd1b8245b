#include "config/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <set>
#include <sstream>
#include <type_traits>

#include "config/fields.h"
#include "options.pb.h"
#include "support/published_options.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using testing_support::PublishedOptions;

/// The text of a file of the repository.
std::string FileText(const std::string& path) {
  std::ifstream file(std::string(VISMAP_SOURCE_DIR) + "/" + path);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

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

/// "section.key" of every key that fields.h has.
std::vector<std::string> AllKeys() {
  std::vector<std::string> keys;
  const VismapConfig config;
  config::ForEachKey(config, [&](const std::string& section, const std::string& key, const auto&) {
    keys.push_back(section + "." + key);
  });
  return keys;
}

TEST(Fields, EveryKeyOfTheProtoIsThereOnce) {
  std::vector<std::string> expected;
  const auto* sections = config::Config::descriptor();
  for (int i = 0; i < sections->field_count(); ++i) {
    const auto* section = sections->field(i);
    for (int j = 0; j < section->message_type()->field_count(); ++j) {
      expected.push_back(section->name() + "." + section->message_type()->field(j)->name());
    }
  }
  EXPECT_THAT(AllKeys(), ::testing::UnorderedElementsAreArray(expected));
}

/// The names in options.proto of the enum that a key takes.
std::vector<std::string> NamesInProto(const std::string& section, const std::string& key) {
  const auto* type = config::Config::descriptor()
                         ->FindFieldByName(section)
                         ->message_type()
                         ->FindFieldByName(key)
                         ->enum_type();
  std::vector<std::string> names;
  for (int i = 0; i < type->value_count(); ++i) names.push_back(type->value(i)->name());
  return names;
}

TEST(Fields, EnumsHaveTheNamesOfTheProto) {
  int enums = 0;
  const VismapConfig config;
  config::ForEachKey(config, [&](const std::string& section, const std::string& key,
                                 const auto& member) {
    using Member = std::decay_t<decltype(member)>;
    if constexpr (std::is_enum_v<Member>) {
      std::vector<std::string> names;
      std::set<Member> values;
      for (const auto& [name, value] : NamesOf(member)) {
        names.push_back(name);
        values.insert(value);
      }
      EXPECT_THAT(names, ::testing::UnorderedElementsAreArray(NamesInProto(section, key))) << key;
      EXPECT_EQ(values.size(), names.size()) << key << ": a value has two names";
      ++enums;
    }
  });
  EXPECT_GE(enums, 6);
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

/// Number of members of an option struct that fields.h names, nested structs included.
template <typename Options>
constexpr size_t FieldCount() {
  return std::tuple_size_v<decltype(config::FieldsOf(Options{}))>;
}

TEST(Fields, EveryMemberOfTheOptionStructsIsThere) {
  EXPECT_EQ(FieldCount<VoxelGridOptions>(), MemberCount<VoxelGridOptions>());
  constexpr size_t kPreset = 1;  // a second key for the noise model
  EXPECT_EQ(FieldCount<SurfaceOptions>(), MemberCount<SurfaceOptions>() + kPreset);
  EXPECT_EQ(FieldCount<DepthNoiseModel>(), MemberCount<DepthNoiseModel>());
  EXPECT_EQ(FieldCount<SegmentationOptions>(), MemberCount<SegmentationOptions>());
  EXPECT_EQ(FieldCount<RefineOptions>(), MemberCount<RefineOptions>());
  constexpr size_t kRange = 2;  // derived
  EXPECT_EQ(FieldCount<AssociationOptions>() + kRange, MemberCount<AssociationOptions>());
  constexpr size_t kNoise = 1;  // derived
  EXPECT_EQ(FieldCount<IntegrationOptions>() + kNoise, MemberCount<IntegrationOptions>());
  EXPECT_EQ(FieldCount<MeshingOptions>(), MemberCount<MeshingOptions>());
  constexpr size_t kUp = 3;  // found for each map, see ObjectOptionsFor
  EXPECT_EQ(FieldCount<ObjectOptions>() + kUp, MemberCount<ObjectOptions>());
  EXPECT_EQ(FieldCount<StructureOptions>(), MemberCount<StructureOptions>());
  EXPECT_EQ(FieldCount<OccupancyOptions>(), MemberCount<OccupancyOptions>());
  constexpr size_t kOfOneTree = 2;  // unknown and bounds_W differ from tree to tree
  EXPECT_EQ(FieldCount<OctreeOptions>() + kOfOneTree, MemberCount<OctreeOptions>());
  EXPECT_EQ(FieldCount<GroundGridOptions>(), MemberCount<GroundGridOptions>());
  EXPECT_EQ(FieldCount<DepthSegmenterOptions>(), MemberCount<DepthSegmenterOptions>());
  EXPECT_EQ(FieldCount<MapServerOptions>(), MemberCount<MapServerOptions>());
  EXPECT_EQ(FieldCount<OctomapExporterOptions>(), MemberCount<OctomapExporterOptions>());
  EXPECT_EQ(FieldCount<ViewerOptions>(), MemberCount<ViewerOptions>());
  EXPECT_EQ(FieldCount<SensorReplayOptions>(), MemberCount<SensorReplayOptions>());
  EXPECT_EQ(FieldCount<DetectorOptions>(), MemberCount<DetectorOptions>());
  EXPECT_EQ(FieldCount<DnnDetectorOptions>(), MemberCount<DnnDetectorOptions>());
  EXPECT_EQ(FieldCount<HubOptions>(), MemberCount<HubOptions>());
  EXPECT_EQ(FieldCount<BridgeOptions>(), MemberCount<BridgeOptions>());
  EXPECT_EQ(FieldCount<SharedOptions>(), MemberCount<SharedOptions>());
  EXPECT_EQ(FieldCount<AdapterCameraOptions>(), MemberCount<AdapterCameraOptions>());
  constexpr size_t kInherited = 1;
  EXPECT_EQ(FieldCount<AdapterOptions>() + kInherited,
            FieldCount<AdapterCameraOptions>() + MemberCount<AdapterOptions>());
}

/// Gives every value another one, so that a key for the wrong member shows.
class Changer {
 public:
  void Change(double& member) { member += 0.001 * ++changes_; }
  void Change(int& member) { member += ++changes_; }
  void Change(bool& member) { member = !member; }
  void Change(std::string& member) { member += "\"\n" + std::to_string(++changes_); }
  void Change(std::vector<std::string>& member) {
    member = {"A.*", "\"" + std::to_string(++changes_)};
  }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void Change(Enum& member) {
    const auto names = NamesOf(member);
    member = member == names[0].value ? names[1].value : names[0].value;
  }
  void Change(std::vector<double>& member) { member = {0.1 * ++changes_, -1.5, 3, 1e-7}; }
  void Change(std::vector<ClassId>& member) {
    member = {ClassId{1}, ClassId{static_cast<uint16_t>(300 + ++changes_)}};
  }
  void Change(std::optional<Eigen::Vector3d>& member) {
    member = Eigen::Vector3d(1.0 / 3, -2.0 / 3, 2.0 / 3);
  }
  void Change(config::NoisePreset<DepthNoiseModel>&) {}
  void Change(std::vector<AdapterCameraOptions>& member) {
    member.resize(2);
    for (AdapterCameraOptions& camera : member) {
      config::ForEachKey(camera, "", [&](const std::string&, auto& key) { Change(key); });
    }
  }
  int changes() const { return changes_; }

 private:
  int changes_ = 0;
};

TEST(Config, PrintedTextParsesBackToTheSame) {
  VismapConfig config;
  EXPECT_EQ(PrintConfig(Parsed(PrintConfig(config))), PrintConfig(config));
  Changer changer;
  config::ForEachKey(config, [&](const std::string&, const std::string&, auto& member) {
    changer.Change(member);
  });
  EXPECT_GT(changer.changes(), 60);
  const VismapConfig again = Parsed(PrintConfig(config));
  EXPECT_EQ(PrintConfig(again), PrintConfig(config));
  EXPECT_EQ(again.grid.voxel_size_m, config.grid.voxel_size_m);
  EXPECT_EQ(again.surface.noise, config.surface.noise);
  EXPECT_EQ(again.refine.split_min_rest_px, config.refine.split_min_rest_px);
  EXPECT_EQ(again.up_W, config.up_W);
  EXPECT_EQ(again.map_server.save_on_exit, config.map_server.save_on_exit);
  EXPECT_NE(PrintConfig(config), PrintConfig(VismapConfig{}));
}

TEST(OptionsProto, EveryKeyHasAComment) {
  std::istringstream lines(FileText("libs/config/options.proto"));
  std::string line, before;
  int keys = 0;
  const std::regex key(R"(  (optional|repeated) \w+ \w+ = \d+.*)");
  for (bool in_section = false; std::getline(lines, line); before = line) {
    if (line.starts_with("message ")) in_section = line != "message Config {";
    if (!in_section || !std::regex_match(line, key)) continue;
    ++keys;
    const bool has_comment = line.find("//") != std::string::npos || before.starts_with("  //");
    EXPECT_TRUE(has_comment) << line;
  }
  EXPECT_GE(keys, static_cast<int>(AllKeys().size()));
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
  expected.refine.split = false;
  EXPECT_EQ(PrintConfig(config), PrintConfig(expected));
}

TEST(ParseConfig, SensorIsAStartThatFieldsChange) {
  DepthNoiseModel expected = RealSenseNoise();
  expected.axial_offset_m = 0.5;
  const VismapConfig config = Parsed("surface { noise_axial_offset_m: 0.5 sensor: REALSENSE }");
  EXPECT_EQ(config.surface.noise, expected);
  EXPECT_EQ(Parsed("surface { sensor: CLEAN }").surface.noise, CleanNoise());
  EXPECT_EQ(Parsed("surface { sensor: REALSENSE }").integration.noise, RealSenseNoise());
}

TEST(ParseConfig, NamesOfChoicesMeanWhatTheySay) {
  const SurfaceOptions surface = Parsed("surface { method: WINDOW_COVARIANCE }").surface;
  EXPECT_EQ(surface.method, NormalMethod::kWindowCovariance);
  EXPECT_EQ(Parsed("surface { method: INVERSE_DEPTH_FIT }").surface.method,
            NormalMethod::kInverseDepthFit);
  EXPECT_EQ(Parsed("segmentation { method: PUBLISHED }").segmentation.method,
            SegmentationMethod::kPublished);
  EXPECT_EQ(Parsed("segmentation { method: NOISE_SCALED }").segmentation.method,
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
  const HubOptions hub = Parsed("hub { lossless: [\"A\", \"B.*\"] latest: \"C\" }").hub;
  EXPECT_THAT(hub.lossless, ::testing::ElementsAre("A", "B.*"));
  EXPECT_THAT(hub.latest, ::testing::ElementsAre("C"));
  EXPECT_THAT(hub.drop_newest, IsEmpty());
}

TEST(ParseConfig, AssociationTakesTheRangeOfTheIntegration) {
  const VismapConfig config = Parsed("integration { min_range_m: 0.4 max_range_m: 3.5 }");
  EXPECT_EQ(config.association.min_range_m, 0.4);
  EXPECT_EQ(config.association.max_range_m, 3.5);
  EXPECT_THAT(Validate(config), IsEmpty());
}

TEST(DeriveOptions, ConfigsMadeByAProgramGetThemToo) {
  VismapConfig config;
  config.integration.max_range_m = 3.5;
  config.surface.noise = RealSenseNoise();
  EXPECT_THAT(Validate(config), ::testing::Contains(HasSubstr("must have one range")));
  DeriveOptions(&config);
  EXPECT_EQ(config.association.max_range_m, 3.5);
  EXPECT_EQ(config.integration.noise, RealSenseNoise());
  EXPECT_THAT(Validate(config), IsEmpty());
}

TEST(DeriveOptions, DefaultsAgreeWithoutIt) {
  const VismapConfig config;
  EXPECT_EQ(config.association.min_range_m, config.integration.min_range_m);
  EXPECT_EQ(config.association.max_range_m, config.integration.max_range_m);
  EXPECT_EQ(config.integration.noise, config.surface.noise);
}

TEST(ParseConfig, ErrorsNameFileLineAndColumn) {
  EXPECT_THAT(ErrorOf("grid {\n  voxel_sise_m: 0.02\n}\n"),
              ::testing::AllOf(HasSubstr("test.txtpb:2:"), HasSubstr("voxel_sise_m")));
  EXPECT_THAT(ErrorOf("grid {\n  voxel_size_m: \"small\"\n}\n"), HasSubstr("test.txtpb:2:"));
  EXPECT_THAT(ErrorOf("refine { split: 3.5 }"), HasSubstr("test.txtpb:1:"));
  EXPECT_THAT(ErrorOf("surface { method: FAST }"), HasSubstr("FAST"));
  EXPECT_THAT(ErrorOf("grid {\n"), HasSubstr("test.txtpb:"));
  EXPECT_THAT(ErrorOf("grid { voxel_size_m: 0.01 voxel_size_m: 0.02 }"), HasSubstr("voxel_size_m"));
  EXPECT_THAT(ErrorOf("association { min_overlap_points: 1e30 }"), HasSubstr("test.txtpb:1:"));
  EXPECT_THAT(ErrorOf("objects { up_W: [0, 1] }"), HasSubstr("objects.up_W: expected three"));
}

TEST(ParseConfig, CamerasBeginWithTheKeysOfTheirSection) {
  const AdapterOptions adapter =
      Parsed(
          "adapter { preset: DIMOS wait_ms: 70 none_values: 2047 "
          "camera { camera_id: 1 camera_frame: \"left\" } "
          "camera { camera_id: 2 wait_ms: 80 none_values: [0, 9] constant_edges: MOVING } }")
          .adapter;
  ASSERT_EQ(adapter.camera.size(), 2u);
  EXPECT_EQ(adapter.camera[0].camera_id, 1);
  EXPECT_EQ(adapter.camera[0].preset, AdapterPreset::kDimos);
  EXPECT_EQ(adapter.camera[0].camera_frame, "left");
  EXPECT_EQ(adapter.camera[0].wait_ms, 70);
  EXPECT_EQ(adapter.camera[0].constant_edges, ConstantEdges::kFixedWhenUnchanged);
  EXPECT_THAT(adapter.camera[0].none_values, ::testing::ElementsAre(2047));
  EXPECT_EQ(adapter.camera[1].wait_ms, 80);
  EXPECT_EQ(adapter.camera[1].constant_edges, ConstantEdges::kMoving);
  EXPECT_THAT(adapter.camera[1].none_values, ::testing::ElementsAre(0, 9));
  EXPECT_TRUE(Parsed("adapter { preset: DIMOS }").adapter.camera.empty());
}

TEST(Validate, CamerasAreChecked) {
  EXPECT_THAT(ErrorOf("adapter { camera {} camera {} }"),
              HasSubstr("adapter.camera 0 is there twice"));
  EXPECT_THAT(ErrorOf("adapter { camera { camera_id: 3 wait_ms: -1 } }"),
              HasSubstr("adapter.camera 3: wait_ms must be in [0, 60000]"));
  EXPECT_THAT(ErrorOf("adapter { camera { robot_url: \"udpm://\" } }"),
              HasSubstr("adapter.camera: robot_url is no key of a camera"));
  EXPECT_THAT(ErrorOf("adapter { camera { camera {} } }"),
              HasSubstr("camera is no key of a camera"));
  EXPECT_THAT(ErrorOf("adapter { none_values: [0, -3] }"), HasSubstr("none_values must be"));
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
  EXPECT_THAT(Validate(config), SizeIs(::testing::Ge(7u)));
  EXPECT_THAT(ErrorOf("grid { voxel_size_m: 0 truncation_voxels: 2 }"),
              ::testing::AllOf(HasSubstr("voxel_size_m"), HasSubstr("; grid.truncation_voxels")));
}

TEST(Validate, CorrectionsNeedTheFramesAndTheseAFolder) {
  VismapConfig config;
  config.map_server.accept_corrections = true;
  EXPECT_THAT(Validate(config), ElementsAre(HasSubstr("needs map_server.frame_journal_mb")));
  config.map_server.frame_journal_mb = 100;
  EXPECT_THAT(Validate(config), ElementsAre(HasSubstr("needs map_server.frame_journal or")));
  config.map_server.frame_journal = "frames";
  EXPECT_THAT(Validate(config), ElementsAre());
}

TEST(Validate, NotANumberIsAProblemWhereverItStands) {
  bool more = true;
  for (int target = 0; more; ++target) {
    VismapConfig config;
    int at = 0;
    config::ForEachKey(config, [&](const std::string&, const std::string&, auto& member) {
      if constexpr (std::is_same_v<std::decay_t<decltype(member)>, double>) {
        if (at++ == target) member = std::nan("");
      }
    });
    more = at > target;
    EXPECT_EQ(!Validate(config).empty(), more) << "double number " << target;
  }
}

TEST(Validate, OctreeResolutionMustFitTheVoxels) {
  EXPECT_THAT(ErrorOf("grid { voxel_size_m: 0.02 } octree { resolution_m: 0.05 }"),
              HasSubstr("nearest is 0.06 m"));
}

VismapConfig Preset(const std::string& name) {
  const Result<VismapConfig> config = ParseValidConfig(FileText("config/" + name), name);
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
  static_cast<SegmentationStageOptions&>(expected) = PublishedOptions();
  expected.refine.min_score = 0.7;  // of the detector, in the published system
  EXPECT_EQ(PrintConfig(preset), PrintConfig(expected));
}

TEST(Config, ClassesToLeaveOutAreNamesOrIds) {
  const VismapConfig config = Parsed("refine { leave_out_classes: [\"person\", \"18\", \"300\"] }");
  EXPECT_THAT(config.refine.leave_out_classes,
              ::testing::ElementsAre(ClassId{1}, ClassId{18}, ClassId{300}));
  EXPECT_TRUE(VismapConfig().refine.leave_out_classes.empty());
}

TEST(Config, AnUnknownClassToLeaveOutIsAnError) {
  for (const std::string name : {"persons", "unknown", "0", "70000", ""}) {
    const auto config = ParseConfig("refine { leave_out_classes: \"" + name + "\" }", "x");
    ASSERT_FALSE(config) << name;
    EXPECT_THAT(config.error().message,
                ::testing::HasSubstr("refine.leave_out_classes: '" + name + "' is neither"));
  }
}

}  // namespace
}  // namespace vismap
