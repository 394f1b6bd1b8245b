#include "base/class_names.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace vismap {
namespace {

// COCO ids 1..91; ids without annotations in COCO 2017 have the names of the paper "COCO-Stuff".
constexpr std::array<std::string_view, 92> kNames{"unknown",      "person",         "bicycle",
                                                  "car",          "motorcycle",     "airplane",
                                                  "bus",          "train",          "truck",
                                                  "boat",         "traffic light",  "fire hydrant",
                                                  "street sign",  "stop sign",      "parking meter",
                                                  "bench",        "bird",           "cat",
                                                  "dog",          "horse",          "sheep",
                                                  "cow",          "elephant",       "bear",
                                                  "zebra",        "giraffe",        "hat",
                                                  "backpack",     "umbrella",       "shoe",
                                                  "eye glasses",  "handbag",        "tie",
                                                  "suitcase",     "frisbee",        "skis",
                                                  "snowboard",    "sports ball",    "kite",
                                                  "baseball bat", "baseball glove", "skateboard",
                                                  "surfboard",    "tennis racket",  "bottle",
                                                  "plate",        "wine glass",     "cup",
                                                  "fork",         "knife",          "spoon",
                                                  "bowl",         "banana",         "apple",
                                                  "sandwich",     "orange",         "broccoli",
                                                  "carrot",       "hot dog",        "pizza",
                                                  "donut",        "cake",           "chair",
                                                  "couch",        "potted plant",   "bed",
                                                  "mirror",       "dining table",   "window",
                                                  "desk",         "toilet",         "door",
                                                  "tv",           "laptop",         "mouse",
                                                  "remote",       "keyboard",       "cell phone",
                                                  "microwave",    "oven",           "toaster",
                                                  "sink",         "refrigerator",   "blender",
                                                  "book",         "clock",          "vase",
                                                  "scissors",     "teddy bear",     "hair drier",
                                                  "toothbrush",   "hair brush"};

}  // namespace

std::string ClassName(ClassId id) {
  const size_t index = Raw(id);
  return index < kNames.size() ? std::string(kNames[index]) : "class " + std::to_string(index);
}

std::optional<ClassId> ClassFromName(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<ClassId>(found - kNames.begin());
}

std::optional<ClassId> ParseClass(std::string_view text) {
  uint16_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error == std::errc() && end == text.data() + text.size()) return static_cast<ClassId>(id);
  return ClassFromName(text);
}

}  // namespace vismap
