#include "viewer/evidence_answers.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/class_names.h"
#include "base/format.h"
#include "base/printable.h"
#include "codecs/color_codec.h"
#include "render/palette.h"
#include "render/png.h"
#include "viewer/mask_overlay.h"

namespace vismap {
namespace {

constexpr int kSmallestWidth = 16, kPictureQuality = 85;
constexpr Rgb8 kDetectionColor{255, 255, 255};
constexpr double kMegabytes = 1e-6, kSeconds = 1e-6;
using EvidenceJson = nlohmann::ordered_json;

// All of the text is one decimal number.
template <typename Number>
std::optional<Number> ParseNumber(std::string_view text, int base = 10) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  const bool plain = !text.empty() && std::isxdigit(static_cast<unsigned char>(text[0])) != 0;
  if (!plain || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

EvidenceJson ViewJson(const EvidenceView& view, const EvidenceQuestion& question,
                      const std::string& name) {
  const FrameHeader& header = view.frame->header;
  const std::string camera = std::to_string(Raw(header.camera_id));
  const std::string utime = std::to_string(header.utime);
  EvidenceJson json{{"camera_id", Raw(header.camera_id)},
                    {"utime", header.utime},
                    {"pixels", view.pixels},
                    {"share", view.mask->share()},
                    {"whole", view.whole}};
  if (view.mask->detection >= 0)
    json["detection"] = {
        {"class", Raw(view.mask->class_id)},
        {"class_name", view.mask->class_id == ClassId::kUnknown ? std::string("unknown")
                                                                : ClassName(view.mask->class_id)},
        {"score", view.mask->score},
        {"overlap", view.mask->overlap}};
  json["T_W_C"] = EvidenceJson::array();
  const Eigen::Matrix4d T_W_C = header.T_W_C.matrix();
  for (Eigen::Index i = 0; i < 16; ++i) json["T_W_C"].push_back(T_W_C(i / 4, i % 4));
  json["width"] = header.camera.width;
  json["height"] = header.camera.height;
  json["url"] = "/api/frame/" + camera + "/" + utime + ".jpg?id=" + name;
  if (question.of_log)
    json["url"] = json["url"].get<std::string>() + "&frames=" + std::to_string(question.revision);
  return json;
}

// "12.34 s"
std::string SecondsText(int64_t utime) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f s", static_cast<double>(utime) * kSeconds);
  return text;
}

// What is kept, in words.
std::string KeptText(const EvidenceStore& store) {
  const auto& frames = store.frames();
  const auto [first, last] = std::minmax_element(
      frames.begin(), frames.end(), [](const EvidenceFramePtr& a, const EvidenceFramePtr& b) {
        return a->header.utime < b->header.utime;
      });
  return FormatCount(static_cast<int64_t>(frames.size()), "frame") +
         (frames.size() == 1 ? " is" : " are") + " kept, of the time from " +
         SecondsText((*first)->header.utime) + " to " + SecondsText((*last)->header.utime);
}

std::string WhyNone(const EvidenceStore& store, bool of_log) {
  if (store.frames().empty() && of_log) return "no frame of the log with colour is kept until then";
  if (store.frames().empty())
    return "no frame is kept yet: none with colour has come on SEGMENTED_FRAME since the viewer "
           "started";
  return "in none of the frames that are kept is enough of it seen; " + KeptText(store);
}

HttpAnswer NotKept(const PictureQuestion& picture, const EvidenceStore& store) {
  return ErrorAnswer(404, "the frame of camera " + std::to_string(Raw(picture.camera)) +
                              " and utime " + std::to_string(picture.utime) +
                              " is not kept, or no longer: " +
                              (store.frames().empty() ? "none is kept" : KeptText(store)));
}

// The outline of what the detector saw, when it agrees with the mask.
void DrawDetection(const EvidenceFrame& frame, const FrameMask& mask, Image<Rgb8>* picture) {
  if (mask.detection < 0) return;
  const Result<Image<uint8_t>> seen = DetectionMask(frame, mask.detection);
  const bool same_size =
      seen && seen->width() == picture->width() && seen->height() == picture->height();
  if (same_size) DrawOutline(*seen, kDetectionColor, picture);
}

HttpAnswer ImageAnswer(const Image<Rgb8>& image, bool png) {
  if (png) return {200, "image/png", EncodePng(image), ""};
  return {200, "image/jpeg", EncodeJpeg(image, kPictureQuality), ""};
}

Rgb8 ColorOf(const PictureQuestion& picture, const ObjectChoice& object) {
  if (picture.color) return *picture.color;
  if (object.instance != InstanceId::kNone) return StrongColor(Raw(object.instance));
  return StrongColor(object.segments.front());
}

Result<void> ReadArguments(const HttpTarget& target, PictureQuestion* question) {
  for (const auto& [key, value] : target.query) {
    if (key == "id") {
      if (!ParseObjectName(value))
        return Fail("frame: id is an instance, such as 7, or a segment, such as s12");
      question->object = value;
    } else if (key == "color") {
      const auto rgb = value.size() == 6 ? ParseNumber<uint32_t>(value, 16) : std::nullopt;
      if (!rgb) return Fail("frame: color is six hexadecimal digits, such as ff8000");
      question->color = Rgb8{static_cast<uint8_t>(*rgb >> 16), static_cast<uint8_t>(*rgb >> 8),
                             static_cast<uint8_t>(*rgb)};
    } else if (key == "width") {
      const auto width = ParseNumber<int>(value);
      if (!width || *width < kSmallestWidth || *width > kMaxImageSide)
        return Fail("frame: width is a number of pixels from 16 to 16384");
      question->width = *width;
    } else {
      return Fail("frame: the arguments are id, color and width");
    }
  }
  return {};
}

}  // namespace

std::optional<ObjectName> ParseObjectName(const std::string& text) {
  const bool is_segment = text.starts_with('s');
  const auto number = ParseNumber<uint32_t>(std::string_view(text).substr(is_segment ? 1 : 0));
  if (!number || *number == 0) return std::nullopt;
  return ObjectName{is_segment, *number};
}

HttpAnswer NoFramesKept() {
  return ErrorAnswer(404, "no frames are kept, since viewer.evidence_mb is 0");
}

HttpAnswer NeedsObjectName() {
  return ErrorAnswer(
      400, "say which object with id=7 (an instance) or id=s12 (a segment without instance)");
}

Result<PictureQuestion> ReadPictureQuestion(const HttpTarget& target) {
  constexpr std::string_view kStart = "/api/frame/";
  const auto wrong = [&] {
    return Fail("expected /api/frame/CAMERA/UTIME.jpg or .png, found '" +
                PrintableText(target.path, 100) + "'");
  };
  if (!target.path.starts_with(kStart)) return wrong();
  const std::string_view rest = std::string_view(target.path).substr(kStart.size());
  const size_t slash = rest.find('/'), dot = rest.rfind('.');
  if (slash == std::string_view::npos || dot == std::string_view::npos || dot < slash)
    return wrong();
  const auto camera = ParseNumber<int32_t>(rest.substr(0, slash));
  const auto utime = ParseNumber<int64_t>(rest.substr(slash + 1, dot - slash - 1));
  const std::string_view kind = rest.substr(dot);
  if (!camera || !utime || (kind != ".jpg" && kind != ".png")) return wrong();
  PictureQuestion question;
  question.camera = CameraId{*camera};
  question.utime = *utime;
  question.png = kind == ".png";
  if (const Result<void> read = ReadArguments(target, &question); !read)
    return tl::unexpected(read.error());
  return question;
}

HttpAnswer EvidenceList(const std::string& name, const EvidenceQuestion& question,
                        EvidenceFinder* finder) {
  const auto views = finder->Find(question);
  if (!views)
    return ErrorAnswer(404, "the map has no surface of the object " + name +
                                ": it was removed or merged, or there never was one");
  const EvidenceStore& store = finder->store();
  EvidenceJson json{{"id", name},
                    {"map_id", question.map_id},
                    {"revision", question.revision},
                    {"frames", EvidenceJson::array()}};
  for (const EvidenceView& view : *views) json["frames"].push_back(ViewJson(view, question, name));
  if (views->empty()) json["why"] = WhyNone(store, question.of_log);
  json["kept"] = {{"frames", store.frames().size()},
                  {"megabytes", static_cast<double>(store.bytes()) * kMegabytes}};
  return JsonAnswer(json.dump(-1, ' ', false, EvidenceJson::error_handler_t::replace));
}

HttpAnswer EvidencePicture(const PictureQuestion& picture, const EvidenceQuestion* object,
                           EvidenceFinder* finder) {
  const EvidenceFramePtr frame = finder->store().Find(picture.camera, picture.utime);
  if (frame == nullptr) return NotKept(picture, finder->store());
  if (object == nullptr && !picture.png && picture.width == 0)
    return {200, "image/jpeg", frame->jpeg, ""};
  const PinholeCamera& camera = frame->header.camera;
  Result<Image<Rgb8>> image = DecodeJpeg(frame->jpeg, camera.width, camera.height);
  if (!image) return ErrorAnswer(500, "the picture is damaged: " + image.error().message);
  const int shorter = std::min(image->width(), image->height());
  const int factor =
      picture.width == 0 ? 1 : std::clamp(image->width() / picture.width, 1, shorter);
  Image<Rgb8> shown = ShrinkPicture(*image, factor);
  if (object != nullptr) {
    const auto mask = finder->MaskOf(*object, frame);
    if (factor == 1) DrawDetection(*frame, *mask, &shown);
    DrawMask(mask->mask.visible, ColorOf(picture, object->object), &shown);
  }
  return ImageAnswer(shown, picture.png);
}

HttpAnswer AnswerInTurn(double asked, double now, const std::function<HttpAnswer()>& work) {
  if (now - asked > kLongestEvidenceWait)
    return ErrorAnswer(503, "other requests for frames took more than 15 s; try again");
  try {
    return work();
  } catch (const std::exception& error) {
    return ErrorAnswer(500, "the frames could not be read: " + std::string(error.what()));
  }
}

}  // namespace vismap
