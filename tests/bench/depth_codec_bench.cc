// Compares lossless codecs for 16-bit depth: ours (zstd over two byte planes of differences), PNG
// and RVL (Wilson, "Fast Lossless Depth Image Compression", 2017), on the depth images of a data
// set:
//   depth_codec_bench --dataset=DIR [Google Benchmark's flags]
// Without --dataset, it uses the built-in room.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "codecs/depth_codec.h"
#include "simulation/sequence.h"

namespace vismap {
namespace {

using Bytes = std::vector<uint8_t>;
using Depth = Image<uint16_t>;

Bytes EncodePng(const Depth& depth) {
  Bytes bytes;
  const cv::Mat mat(depth.height(), depth.width(), CV_16UC1, const_cast<uint16_t*>(depth.data()));
  cv::imencode(".png", mat, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  return bytes;
}

Depth DecodePng(const Bytes& bytes, int width, int height) {
  Depth depth(width, height);
  const cv::Mat mat = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  std::memcpy(depth.data(), mat.data, 2 * depth.size());
  return depth;
}

/// Writes numbers in groups of 3 bits and a continuation bit, with two groups per byte.
struct NibbleWriter {
  Bytes bytes;
  bool half = false;

  void Put(uint32_t number) {
    do {
      const auto nibble = static_cast<uint8_t>((number & 7) | (number > 7 ? 8 : 0));
      if (half) {
        bytes.back() = static_cast<uint8_t>(bytes.back() | nibble << 4);
      } else {
        bytes.push_back(nibble);
      }
      half = !half;
      number >>= 3;
    } while (number != 0);
  }
};

Bytes EncodeRvl(const Depth& depth) {
  NibbleWriter out;
  int last = 0;
  const auto& pixels = depth.pixels();
  for (size_t i = 0; i < pixels.size();) {
    size_t zeros = i;
    while (zeros < pixels.size() && pixels[zeros] == 0) ++zeros;
    size_t end = zeros;
    while (end < pixels.size() && pixels[end] != 0) ++end;
    out.Put(static_cast<uint32_t>(zeros - i));
    out.Put(static_cast<uint32_t>(end - zeros));
    for (i = zeros; i < end; ++i) {
      const int difference = pixels[i] - last;
      out.Put(static_cast<uint32_t>((difference << 1) ^ (difference >> 31)));
      last = pixels[i];
    }
  }
  return out.bytes;
}

Depth DecodeRvl(const Bytes& bytes, int width, int height) {
  Depth depth(width, height);
  size_t nibble = 0;
  const auto next = [&] {
    uint32_t number = 0;
    for (int shift = 0;; shift += 3, ++nibble) {
      const uint32_t group = (bytes[nibble / 2] >> (nibble % 2 * 4)) & 15u;
      number |= (group & 7) << shift;
      if (group < 8) break;
    }
    ++nibble;
    return number;
  };
  int last = 0;
  for (size_t i = 0; i < depth.size();) {
    i += next();
    for (uint32_t count = next(); count > 0; --count, ++i) {
      const uint32_t folded = next();
      last += static_cast<int>(folded >> 1) ^ -static_cast<int>(folded & 1);
      depth.data()[i] = static_cast<uint16_t>(last);
    }
  }
  return depth;
}

Depth DecodeOurs(const Bytes& bytes, int width, int height) {
  return *DecodeDepth(bytes, width, height);
}

struct Codec {
  const char* name;
  Bytes (*encode)(const Depth&);
  Depth (*decode)(const Bytes&, int, int);
};

constexpr Codec kCodecs[] = {{"zstd_planes", EncodeDepth, DecodeOurs},
                             {"png", EncodePng, DecodePng},
                             {"rvl", EncodeRvl, DecodeRvl}};

void Encode(benchmark::State& state, const Codec& codec, const std::vector<Depth>& images) {
  size_t i = 0, bytes = 0;
  for (auto _ : state) bytes += codec.encode(images[i++ % images.size()]).size();
  state.counters["kB"] = static_cast<double>(bytes) / 1e3 / static_cast<double>(i);
}

void Decode(benchmark::State& state, const Codec& codec, const std::vector<Depth>& images) {
  std::vector<Bytes> codes;
  for (const Depth& image : images) {
    codes.push_back(codec.encode(image));
    if (codec.decode(codes.back(), image.width(), image.height()) != image) {
      state.SkipWithError("not lossless");
    }
  }
  size_t i = 0;
  for (auto _ : state) {
    const Depth& like = images[i % images.size()];
    benchmark::DoNotOptimize(codec.decode(codes[i++ % codes.size()], like.width(), like.height()));
  }
}

int Run(const std::string& path) {
  const auto dataset = OpenSequence(path, "", {.stride = 5, .max_frames = 16});
  if (!dataset) {
    std::fprintf(stderr, "%s\n", dataset.error().message.c_str());
    return 3;
  }
  std::vector<Depth> images;
  for (size_t i = 0; i < (*dataset)->size(); ++i) images.push_back((*dataset)->Read(i)->depth);
  for (const Codec& codec : kCodecs) {
    const auto name = [&](const char* what) { return std::string(what) + "/" + codec.name; };
    benchmark::RegisterBenchmark(name("encode").c_str(), Encode, codec, images)
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(name("decode").c_str(), Decode, codec, images)
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace vismap

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const std::string flag = "--dataset=";
  std::string path = "synthetic:room?frames=16";
  if (argc > 1 && std::string(argv[1]).starts_with(flag)) path = argv[1] + flag.size();
  return vismap::Run(path);
}
