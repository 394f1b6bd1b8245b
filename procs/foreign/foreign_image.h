#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"

namespace vismap {

/// What the bytes of an image are. Rows have no padding; numbers are little-endian.
enum class PixelFormat {
  kRgb,
  kBgr,
  kRgba,
  kBgra,
  kGrey,
  kJpeg,
  kPng,
  kDepth16,      ///< uint16
  kDepth16Zlib,  ///< the same in a zlib stream
  kDepthPng,     ///< PNG with 16 bits
  kDepthFloat,   ///< float32 [m]
};

/// An image as a robot's message has it.
struct ForeignImage {
  int64_t utime = 0;          ///< when it was taken [us]
  std::string frame_id = {};  ///< of the camera's optical frame; "" = not stated
  int width = 0, height = 0;
  PixelFormat format = PixelFormat::kRgb;
  std::vector<uint8_t> bytes = {};
  int64_t message = -1;  ///< which message it came in, as the caller of the joiner counts
};

/// The pixels of a message as they are sent.
struct RawPixels {
  int width = 0, height = 0;
  int64_t row_bytes = 0;  ///< from one row to the next; 0 = without padding
  int pixel_bytes = 1;
  int value_bytes = 1;  ///< of a channel of a pixel
  bool big_endian = false;
  std::vector<uint8_t> bytes = {};
};

/// Removes the padding of the rows and makes the values little-endian. Fails on sizes that are
/// impossible or do not fit the bytes.
Result<std::vector<uint8_t>> TightRows(RawPixels pixels);

/// Unpacks a zlib stream that holds exactly `bytes` bytes.
Result<std::vector<uint8_t>> InflateZlib(const std::vector<uint8_t>& packed, size_t bytes);

/// float64 to float32.
std::vector<uint8_t> FloatsOfDoubles(const std::vector<uint8_t>& doubles);
/// The upper byte of each uint16.
std::vector<uint8_t> UpperBytes(const std::vector<uint8_t>& values);
/// int16 to uint16: negative values become 0.
void ClearNegative(std::vector<uint8_t>* values);

/// Makes pixels of a depth image with one of these values "not measured": 0, or NaN of floats. An
/// image that is packed becomes raw when there are values besides 0 and 65535, which every reader
/// knows. Fails on an image that cannot be decoded.
Result<ForeignImage> ClearNoneValues(ForeignImage image, const std::vector<double>& none_values);

/// Fails when the pixels cannot be decoded. Those that are not packed always can.
Result<void> CheckPixels(const ForeignImage& image);

/// Exchanges red and blue of a colour image. A JPEG and a PNG become raw. Fails on those that
/// cannot be decoded.
Result<ForeignImage> SwapRedBlue(ForeignImage image);

}  // namespace vismap
