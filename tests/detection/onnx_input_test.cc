#include "detection/onnx_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "support/tiny_onnx.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<int> ShapeIn(const std::string& model) {
  return OnnxImageShape({reinterpret_cast<const uint8_t*>(model.data()), model.size()});
}

TEST(OnnxImageShape, IsTheFirstInputThatCanBeAnImage) {
  EXPECT_THAT(ShapeIn(TinyYolo().Model()), ElementsAre(1, 3, 64, 64));
  OnnxGraph graph;
  graph.AddInput("weights", {7});
  graph.AddInput("images", {1, 3, 240, -1});
  EXPECT_THAT(ShapeIn(graph.Model()), ElementsAre(1, 3, 240, 0)) << "open sides are 0";
}

TEST(OnnxImageShape, CutAndForeignBytesAreNoShapeAndNoCrash) {
  const std::string model = TinyYolo().Model();
  for (size_t size = 0; size < 200; ++size) {
    const std::vector<int> shape = ShapeIn(model.substr(0, size));
    EXPECT_TRUE(shape.empty() || shape.size() == 4);
  }
  EXPECT_THAT(ShapeIn("this is no model"), IsEmpty());
  EXPECT_THAT(ShapeIn(std::string(100, '\xff')), IsEmpty());
}

}  // namespace
}  // namespace vismap
