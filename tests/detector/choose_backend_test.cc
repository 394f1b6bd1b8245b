#include "detector/choose_backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::HasSubstr;

DetectorOptions With(DetectorBackend backend, const std::string& model) {
  DetectorOptions config;
  config.backend = backend;
  config.dnn.model = model;
  return config;
}

TEST(ChooseBackend, AutoDependsOnTheGivenInput) {
  constexpr auto kAuto = DetectorBackend::kAuto;
  EXPECT_EQ(*ChooseBackend(With(kAuto, ""), true), DetectorBackend::kRecorded);
  EXPECT_EQ(*ChooseBackend(With(kAuto, "m.onnx"), false), DetectorBackend::kDnn);
  EXPECT_EQ(*ChooseBackend(With(kAuto, "m.onnx"), true), DetectorBackend::kRecorded)
      << "the command line overrides the model of the config";
  const auto none = ChooseBackend(With(kAuto, ""), false);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("--model"));
}

TEST(ChooseBackend, ChosenBackendNeedsItsInput) {
  EXPECT_FALSE(ChooseBackend(With(DetectorBackend::kRecorded, "m.onnx"), false));
  EXPECT_FALSE(ChooseBackend(With(DetectorBackend::kDnn, ""), false));
  EXPECT_FALSE(ChooseBackend(With(DetectorBackend::kDnn, "m.onnx"), true));
  EXPECT_EQ(*ChooseBackend(With(DetectorBackend::kDnn, "m.onnx"), false), DetectorBackend::kDnn);
}

}  // namespace
}  // namespace vismap
