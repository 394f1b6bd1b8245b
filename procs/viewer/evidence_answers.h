#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "viewer/evidence_finder.h"
#include "viewer/http_rules.h"

namespace vismap {

/// An object as pages name it: 7 = an instance, s12 = what has no instance and the segment 12.
struct ObjectName {
  bool is_segment = false;
  uint32_t number = 0;
};
std::optional<ObjectName> ParseObjectName(const std::string& text);
/// Says that viewer.evidence_mb is 0.
HttpAnswer NoFramesKept();
/// Says that an object has to be named.
HttpAnswer NeedsObjectName();

/// GET /api/frame/CAMERA/UTIME.jpg or .png, with the arguments id, color and width.
struct PictureQuestion {
  CameraId camera{0};
  int64_t utime = 0;
  bool png = false;
  std::string object;         ///< whose mask is drawn; empty = none
  std::optional<Rgb8> color;  ///< of the mask
  int width = 0;              ///< about, of a smaller picture [px]; 0 = as it came
};
Result<PictureQuestion> ReadPictureQuestion(const HttpTarget& target);

/// The answer of /api/evidence about an object with this name. Says why when there is no view.
HttpAnswer EvidenceList(const std::string& name, const EvidenceQuestion& question,
                        EvidenceFinder* finder);
/// `object` is nullptr when no mask is drawn.
HttpAnswer EvidencePicture(const PictureQuestion& picture, const EvidenceQuestion* object,
                           EvidenceFinder* finder);

inline constexpr double kLongestEvidenceWait = 15;  ///< [s] as long as pages wait for an answer
/// The answer of `work` to a request that came at `asked` [s, MonotonicSeconds] and whose turn it
/// is at `now`. After kLongestEvidenceWait it is 503, and `work` is not called. An exception of
/// `work` is answered by 500.
HttpAnswer AnswerInTurn(double asked, double now, const std::function<HttpAnswer()>& work);

}  // namespace vismap
