#include "render/palette.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vismap {
namespace {

// Hue, saturation and value in [0, 1].
Rgb8 FromHsv(double hue, double saturation, double value) {
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue * 6, 6.0);
    const double c = value - value * saturation * std::clamp(std::min(k, 4 - k), 0.0, 1.0);
    return static_cast<uint8_t>(std::lround(255 * c));
  };
  return {channel(5), channel(3), channel(1)};
}

double Fraction(double value) { return value - std::floor(value); }

// Multiples of the golden ratio are evenly spread over the colour circle for any number of ids.
double Hue(uint32_t id) { return Fraction(0.08 + id * 0.61803398874989485); }

}  // namespace

Rgb8 StrongColor(uint32_t id) {
  if (id == 0) return kUnsegmentedColor;
  // After some ids, hues are close to earlier ones. Two levels of brightness and of saturation keep
  // such colours different.
  const double value = 0.95 - 0.22 * (id / 5 % 2);
  const double saturation = 0.85 - 0.25 * (id / 10 % 2);
  return FromHsv(Hue(id), saturation, value);
}

Rgb8 PaleColor(uint32_t id) {
  if (id == 0) return kUnsegmentedColor;
  return FromHsv(Hue(id), 0.16, 0.80 + 0.05 * (id / 5 % 3));
}

Rgb8 RampColor(double value) {
  constexpr std::array<Rgb8, 6> kPoints{{{0, 34, 78},
                                         {53, 69, 108},
                                         {102, 105, 112},
                                         {148, 142, 119},
                                         {200, 184, 102},
                                         {254, 232, 56}}};
  const double at = value > 0 ? std::min(value, 1.0) * (kPoints.size() - 1) : 0;
  const size_t left = std::min(static_cast<size_t>(at), kPoints.size() - 2);
  const double share = at - static_cast<double>(left);
  const auto mix = [&](uint8_t Rgb8::*channel) {
    return static_cast<uint8_t>(
        std::lround(kPoints[left].*channel * (1 - share) + kPoints[left + 1].*channel * share));
  };
  return {mix(&Rgb8::r), mix(&Rgb8::g), mix(&Rgb8::b)};
}

Rgb8 VertexColor(const MeshVertex& vertex, Coloring coloring) {
  switch (coloring) {
    case Coloring::kRgb:
      return vertex.color;
    case Coloring::kSegment:
      return StrongColor(Raw(vertex.segment));
    case Coloring::kClass:
      if (vertex.class_id != ClassId::kUnknown) return StrongColor(Raw(vertex.class_id));
      break;
    case Coloring::kInstance:
      if (vertex.instance != InstanceId::kNone) return StrongColor(Raw(vertex.instance));
      break;
  }
  return PaleColor(Raw(vertex.segment));
}

}  // namespace vismap
